#pragma once

/// @file
/// Elevation and azimuth without the flip at the pole: theta goes on beyond 90 deg while phi stays,
/// for a vehicle whose set-points do the same.

#include <Eigen/Core>

#include "common/tether_geometry.h"

namespace tautline {

/// The chart, kept from cycle to cycle. Its azimuth is reckoned from the commanded rate and
/// corrected by the measured position, the less the nearer the axis: there the measured azimuth is
/// noise, and a chart that turned with it would come out on the wrong side. Real-time safe: no
/// allocation, no locks, no exceptions.
class UnwrappedChart {
 public:
  /// Starts anew, folded, at the next follow().
  void reset() noexcept { started_ = false; }

  /// Follows the drone to p_AD [m], `seconds` after the last call, and returns (L, theta, phi):
  /// theta in (-pi, pi], beyond
  /// +-90 deg on the far side of the axis. `phi_rate`: azimuth rate commanded since then [rad/s].
  /// `damping_radius` d [m], > 0: how near the axis the azimuth stops to count, eq. (C12).
  TetherCoordinates follow(double seconds, const Eigen::Vector3d& p_AD, double phi_rate,
                           double damping_radius) noexcept;

  /// Damped inverse of J at the chart's present point: azimuth rate v_phi rho / (rho^2 + d^2), rho
  /// = L cos theta (signed).
  [[nodiscard]] TetherRates rates(const Eigen::Vector3d& v_AD) const noexcept;

 private:
  bool started_{false};
  double d_{1.0};
  TetherCoordinates q_;
};

}  // namespace tautline
