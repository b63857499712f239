#pragma once

/// @file
/// Straight down where the drone is, for a flight whose position is no longer known: dead reckoning
/// from the last place that could be trusted (docs/control.md).
///
/// A tether-stabilized vehicle holds its set-points by its own sensors, so rates still move it by
/// what they say when the station hears nothing of length and angles any more.

#include <optional>

#include <Eigen/Core>

#include "common/time.h"
#include "control/controller.h"
#include "control/vehicle_limits.h"

namespace tautline {

/// Real-time safe throughout: no allocation, no locks, no exceptions.
class Descent {
 public:
  /// From p_AD [m], `height` [m] above the ground.
  void begin(const Eigen::Vector3d& p_AD, double height) noexcept;

  /// One cycle at `speed` [m/s], slower where a rate would pass its limit: (C13). Once it must have
  /// met the ground the elevation alone goes on, which brings down even a drone whose tether pulls
  /// no more. `altitude` above the take-off [m]: only if fresh.
  [[nodiscard]] RateCommand update(Duration dt, double speed, const VehicleLimits& limits,
                                   std::optional<double> altitude) noexcept;

  /// It must have met the ground, and the altitude does not gainsay it.
  [[nodiscard]] bool onGround() const noexcept;

 private:
  [[nodiscard]] bool reckonedDown() const noexcept;

  Eigen::Vector3d p_AD_{Eigen::Vector3d::Zero()};  ///< Reckoned [m].
  double ground_{0.0};                             ///< Its height over A [m].
  std::optional<double> altitude_;                 ///< Smoothed [m].
  double lowest_{0.0};                             ///< Least smoothed altitude so far [m].
  Duration no_lower_for_{0};
};

}  // namespace tautline
