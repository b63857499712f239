#include "control/unwrapped_chart.h"

#include <algorithm>
#include <cmath>

namespace tautline {

TetherCoordinates UnwrappedChart::follow(double seconds, const Eigen::Vector3d& p_AD,
                                         double phi_rate, double damping_radius) noexcept {
  constexpr double kCorrectionTime = 0.3;  // [s]: about the vehicle's own lag
  double phi = started_ ? q_.phi + phi_rate * seconds : toTether(p_AD).phi;
  // In the plane of the chart: rho along azimuth phi (negative beyond the axis), side across it.
  const double rho = p_AD.x() * std::sin(phi) + p_AD.z() * std::cos(phi);
  const double side = p_AD.x() * std::cos(phi) - p_AD.z() * std::sin(phi);
  const double share = std::pow(rho / damping_radius, 4);
  const double trust = share / (1.0 + share);
  const double step = started_ ? -std::expm1(-seconds / kCorrectionTime) : 0.0;
  if (rho != 0.0) phi += trust * step * std::atan(side / rho);

  started_ = true;
  d_ = damping_radius;
  q_ = {.L = p_AD.norm(), .theta = std::atan2(p_AD.y(), rho), .phi = wrapAngle(phi)};
  return q_;
}

TetherRates UnwrappedChart::rates(const Eigen::Vector3d& v_AD) const noexcept {
  constexpr double kLeastLength = 0.05;  // [m]: at the anchor itself elevation means nothing
  const double sin_theta = std::sin(q_.theta), cos_theta = std::cos(q_.theta);
  const double sin_phi = std::sin(q_.phi), cos_phi = std::cos(q_.phi);
  const Eigen::Vector3d e_L(cos_theta * sin_phi, sin_theta, cos_theta * cos_phi);
  const Eigen::Vector3d e_theta(-sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi);
  const Eigen::Vector3d e_phi(cos_phi, 0.0, -sin_phi);
  const double rho = q_.L * cos_theta;
  return {.L_dot = v_AD.dot(e_L),
          .theta_dot = v_AD.dot(e_theta) / std::max(q_.L, kLeastLength),
          .phi_dot = v_AD.dot(e_phi) * rho / (rho * rho + d_ * d_)};
}

}  // namespace tautline
