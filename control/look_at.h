#pragma once

/// @file
/// Turns the drone and its camera towards a point in the world.

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/fields.h"
#include "control/vehicle_limits.h"

namespace tautline {

struct LookAtConfig {
  double yaw_gain_per_s{0.8};
  double gimbal_gain_per_s{0.8};
  double min_distance_m{0.2};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("yaw_gain_per_s", yaw_gain_per_s, Range{0.0, 10.0}, "yaw rate over yaw error");
    v.field("gimbal_gain_per_s", gimbal_gain_per_s, Range{0.0, 10.0},
            "gimbal pitch rate over pitch error");
    v.field("min_distance_m", min_distance_m, Range{0.01, 10.0},
            "points nearer than this in plan leave the yaw alone");
  }
};

struct LookAtRates {
  double yaw_rate{0.0};           ///< About +y [rad/s].
  double gimbal_pitch_rate{0.0};  ///< Up positive [rad/s].
};

/// Azimuth of the body's forward axis: atan2(x, z) of R_WB e_x [rad]. Empty if that axis is within
/// 1 deg of vertical. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] std::optional<double> headingOf(const Eigen::Quaterniond& R_WB) noexcept;

/// Rates towards p_WL, by the shorter way round, clamped to `limits`. A missing or unusable `R_WB`
/// or `gimbal_pitch` (above the horizon [rad]) leaves its axis at rest. Real-time safe: no
/// allocation, no locks, no exceptions.
[[nodiscard]] LookAtRates lookAt(const LookAtConfig& config, const VehicleLimits& limits,
                                 const Eigen::Vector3d& p_WD, const Eigen::Vector3d& p_WL,
                                 const std::optional<Eigen::Quaterniond>& R_WB,
                                 const std::optional<double>& gimbal_pitch) noexcept;

}  // namespace tautline
