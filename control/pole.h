#pragma once

/// @file
/// The vertical axis through the active anchor, where elevation and azimuth are singular, and how
/// to fly round it.
///
/// A tether-stabilized vehicle whose elevation set-point stops at 90 deg cannot cross that axis:
/// beyond it the measured azimuth flips by 180 deg, the elevation rate changes its sign, the
/// azimuth set-point does not follow at once, and the vehicle is pushed back: a limit cycle. So the
/// drone goes round the axis, on a circle on which its azimuth set-point can keep up
/// (docs/control.md, "The pole").

#include <Eigen/Core>

#include "common/fields.h"
#include "control/vehicle_limits.h"

namespace tautline {

struct PoleConfig {
  double detour_speed_mps{0.15};
  double rate_reserve{1.3};
  double radius_max_m{0.35};
  double margin_m{0.15};
  double approach_time_s{0.8};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("detour_speed_mps", detour_speed_mps, Range{0.01, 1.0},
            "speed round the axis, at most");
    v.field("rate_reserve", rate_reserve, Range{1.0, 5.0},
            "largest azimuth rate over the one needed on the detour");
    v.field("radius_max_m", radius_max_m, Range{0.05, 2.0},
            "largest detour radius; a slow azimuth lowers the speed instead");
    v.field("margin_m", margin_m, Range{0.0, 1.0}, "how far outside the detour radius it begins");
    v.field("approach_time_s", approach_time_s, Range{0.1, 10.0},
            "time to slow down in when heading for the axis");
  }
};

/// The detour as it is for one vehicle.
struct PoleCylinder {
  double speed{0.0};   ///< On the detour [m/s].
  double radius{0.0};  ///< r_in [m] = rate_reserve speed / phi_dot_max, eq. (C6).
  double outer_radius{
      0.0};  ///< r_in + margin [m]: waypoints inside are passed by progress, not by closeness.
};

/// Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] PoleCylinder poleCylinder(const PoleConfig& config,
                                        const VehicleLimits& limits) noexcept;

/// Horizontal distance of D from the axis [m]. Real-time safe: no allocation, no locks, no
/// exceptions.
[[nodiscard]] double axisDistance(const Eigen::Vector3d& p_AD) noexcept;

/// Steers round the axis. Remembers the side it has chosen, so that noise cannot turn it back and
/// forth. Real-time safe: no allocation, no locks, no exceptions.
class PoleDetour {
 public:
  explicit PoleDetour(const PoleConfig& config) noexcept : config_(config) {}

  void reset() noexcept { side_ = 0.0; }

  /// A goal that the vehicle can have: `goal` itself outside the cylinder. Inside, the point where
  /// the path leaves the cylinder again along `heading`, or, if that is zero or vertical because
  /// the path ends or climbs inside, the cylinder's surface at the drone's own azimuth. All
  /// relative to A, axes of W; `heading` of any length.
  [[nodiscard]] static Eigen::Vector3d outsideGoal(const PoleCylinder& pole,
                                                   const Eigen::Vector3d& p_AD,
                                                   const Eigen::Vector3d& goal,
                                                   const Eigen::Vector3d& heading) noexcept;

  /// Velocity towards `goal` with at most `speed` [m/s], bent round the cylinder and slowed near
  /// it, eq. (C7).
  [[nodiscard]] Eigen::Vector3d steer(const PoleCylinder& pole, const Eigen::Vector3d& p_AD,
                                      const Eigen::Vector3d& goal, double speed) noexcept;

 private:
  PoleConfig config_;
  double side_{0.0};  ///< +1: azimuth grows on the detour, -1: it falls, 0: not on a detour.
};

}  // namespace tautline
