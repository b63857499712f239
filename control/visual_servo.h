#pragma once

/// @file
/// Keeps a pose relative to something that moves and is tracked: a fiducial marker in the camera's
/// picture, or a gripper whose joints are known. Dissertation sections 5.4 and 6.4. It turns
/// sightings into stick movements, so that an operator's program can fly it under all the station's
/// protections (TELEOP). Equations (C14)-(C16) of docs/control.md.

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/estimate.h"
#include "common/fields.h"
#include "common/time.h"
#include "common/vehicle.h"
#include "control/look_at.h"
#include "control/position_law.h"
#include "control/vehicle_limits.h"

namespace tautline {

enum class ServoLaw : std::uint8_t {
  kTracking,     ///< Velocity: the target's own, plus feedback; through the inverse Jacobian.
  kAsPublished,  ///< Three independent laws on (L, theta, phi) towards where it was last seen.
};
inline constexpr std::array<EnumName<ServoLaw>, 2> kServoLawNames{
    {{ServoLaw::kTracking, "tracking"}, {ServoLaw::kAsPublished, "as-published"}}};

struct VisualServoConfig {
  ServoLaw law{ServoLaw::kTracking};
  double standoff_m{0.85};
  double gain_per_s{0.7};
  double speed_max_mps{0.4};
  double track_time_s{0.6};
  double lost_after_s{2.0};
  double vehicle_lag_s{0.3};
  LookAtConfig look_at;
  PositionLawConfig position;

  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("law", law, kServoLawNames, "how the drone is moved");
    v.field("standoff_m", standoff_m, Range{0.1, 20.0},
            "distance to keep along the target's normal");
    v.field("gain_per_s", gain_per_s, Range{0.05, 5.0}, "tracking: speed over position error");
    v.field("speed_max_mps", speed_max_mps, Range{0.01, 5.0}, "tracking: largest speed");
    v.field("track_time_s", track_time_s, Range{0.05, 10.0},
            "tracking: time over which the target's velocity is learned");
    v.field("lost_after_s", lost_after_s, Range{0.1, 60.0},
            "without a sighting for this long the drone stands still");
    v.field("vehicle_lag_s", vehicle_lag_s, Range{0.0, 2.0},
            "tracking: time until commanded rates work");
    v.section("look_at", look_at);
    v.section("position", position);
  }
};

/// The target as it was seen from the camera: frame C with x along the optical axis and y up, frame
/// M with x out of the target's face.
struct Sighting {
  Time taken{};                                         ///< When the picture was.
  Eigen::Vector3d p_CM{Eigen::Vector3d::Zero()};        ///< [m]
  Eigen::Vector3d normal_C{-Eigen::Vector3d::UnitX()};  ///< Out of its face, unit.
};

struct ServoInput {
  Estimate estimate;
  Anchor anchor;
  VehicleLimits limits;
  std::optional<Eigen::Quaterniond> R_WB{};  ///< Only if fresh.
  std::optional<double> gimbal_pitch{};      ///< Above the horizon [rad]; only if fresh.
  std::optional<Sighting> sighting{};        ///< The newest; the same one may come again.
};

/// Real-time safe throughout: no allocation, no locks, no exceptions; no clock.
class VisualServo {
 public:
  explicit VisualServo(const VisualServoConfig& config) noexcept
      : config_(config), position_(config.position) {}

  /// One cycle. All rates are zero while there is no target, or the estimate cannot be used.
  [[nodiscard]] TeleopRates update(Time now, const ServoInput& in) noexcept;

  /// Where the drone should be [m], in W; none: no target.
  [[nodiscard]] std::optional<Eigen::Vector3d> goal(Time now) const noexcept;

 private:
  struct Target {
    Time taken{};
    Eigen::Vector3d p_WM{Eigen::Vector3d::Zero()};
    Eigen::Vector3d v_WM{Eigen::Vector3d::Zero()};
    Eigen::Vector3d normal_W{Eigen::Vector3d::UnitX()};
  };

  void take(Time now, const ServoInput& in) noexcept;
  [[nodiscard]] RateCommand tracking(Time now, const ServoInput& in) const noexcept;

  VisualServoConfig config_;
  PositionLaw position_;
  std::optional<Target> target_;
};

}  // namespace tautline
