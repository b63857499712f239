#pragma once

/// @file
/// What no sensor knows: the true state of the simulated machine. For the bench, displays and
/// tests only.

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/time.h"

namespace tautline {
class sim_truth_t;
}

namespace tautline::sim {

/// Why a flight ended in a crash.
enum class CrashReason : std::uint8_t {
  kNone,
  kHardLanding,  ///< Met the ground faster than the vehicle survives.
  kObstacle,     ///< Touched an obstacle of the scene.
  kRoom,         ///< Touched a wall or the ceiling of the room.
};
inline constexpr std::array<EnumName<CrashReason>, 4> kCrashReasonNames{
    {{CrashReason::kNone, "none"},
     {CrashReason::kHardLanding, "hard landing"},
     {CrashReason::kObstacle, "touched an obstacle"},
     {CrashReason::kRoom, "touched a wall or the ceiling"}}};

/// World frame W (origin at the reel outlet, y up), SI units.
struct Truth {
  Time time{};                                    ///< Virtual clock.
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};  ///< Tether attachment at the drone [m].
  Eigen::Vector3d v_WD{Eigen::Vector3d::Zero()};  ///< [m/s]
  double tension{0.0};                            ///< Tether tension at the drone [N].
  double reel_tension{0.0};                       ///< Tether tension at the reel outlet [N].
  double length{0.0};                             ///< Unstretched tether out [m].
  double reel_scale{1.0};                         ///< True metres per nominal metre of the encoder.
  double tangent_elevation{0.0};                  ///< Of the tether's tangent at the drone [rad].
  double tangent_azimuth{0.0};                    ///< [rad], about +y from z towards x, (-pi, pi].
  double setpoint_elevation{0.0};                 ///< The vehicle's own set-point [rad].
  double setpoint_azimuth{0.0};                   ///< [rad], not wrapped.
  double yaw{0.0};                                ///< Heading about +y [rad].
  double gimbal_pitch{0.0};                       ///< Of the camera above the horizon [rad].
  bool on_ground{true};
  bool motors_on{false};
  bool crashed{false};
  CrashReason crash_reason{CrashReason::kNone};
  int contact_count{0};  ///< Places where the tether rests on an obstacle.
  Eigen::Vector3d p_WA{
      Eigen::Vector3d::Zero()};  ///< Last such place before the drone; the reel if none.
  Eigen::Vector3d gust{Eigen::Vector3d::Zero()};  ///< Air velocity at the drone [m/s].
};

/// The SIM_TRUTH message of a truth. Real-time safe: no allocation, no locks, no exceptions.
void fillTruth(const Truth& truth, std::int64_t utime, tautline::sim_truth_t& message) noexcept;

}  // namespace tautline::sim
