#include "common/tether_geometry.h"

#include <cmath>
#include <numbers>

namespace tautline {

double wrapAngle(double angle) noexcept {
  constexpr double kPi = std::numbers::pi;
  if (angle > -kPi && angle <= kPi) return angle;
  const double wrapped = std::remainder(angle, 2.0 * kPi);  // in [-pi, pi]
  return wrapped <= -kPi ? kPi : wrapped;
}

TetherCoordinates toTether(const Eigen::Vector3d& p_AD) noexcept {
  // atan2 keeps full precision near the vertical axis, where asin(y/L) of eq. (2) loses half the
  // digits.
  return {
      .L = std::hypot(p_AD.x(), p_AD.y(), p_AD.z()),
      .theta = std::atan2(p_AD.y(), std::hypot(p_AD.x(), p_AD.z())),
      .phi = p_AD.x() == 0.0 && p_AD.z() == 0.0 ? 0.0 : wrapAngle(std::atan2(p_AD.x(), p_AD.z()))};
}

Eigen::Vector3d toCartesian(const TetherCoordinates& q) noexcept {
  const double c = std::cos(q.theta);
  return q.L * Eigen::Vector3d(c * std::sin(q.phi), std::sin(q.theta), c * std::cos(q.phi));
}

Eigen::Matrix3d jacobian(const TetherCoordinates& q) noexcept {
  const double s_theta = std::sin(q.theta);
  const double c_theta = std::cos(q.theta);
  const double s_phi = std::sin(q.phi);
  const double c_phi = std::cos(q.phi);
  Eigen::Matrix3d J;
  J << c_theta * s_phi, -q.L * s_theta * s_phi, q.L * c_theta * c_phi,  //
      s_theta, q.L * c_theta, 0.0,                                      //
      c_theta * c_phi, -q.L * s_theta * c_phi, -q.L * c_theta * s_phi;
  return J;
}

Eigen::Vector3d velocityFromRates(const TetherCoordinates& q, const TetherRates& rates) noexcept {
  return jacobian(q) * Eigen::Vector3d(rates.L_dot, rates.theta_dot, rates.phi_dot);
}

TetherRates ratesFromVelocity(const TetherCoordinates& q, const Eigen::Vector3d& v_AD) noexcept {
  const Eigen::Vector3d J_transposed_v = jacobian(q).transpose() * v_AD;
  const double r = q.L * std::cos(q.theta);
  TetherRates rates{.L_dot = J_transposed_v(0)};
  if (std::abs(q.L) >= kSingularRadius) rates.theta_dot = J_transposed_v(1) / (q.L * q.L);
  if (std::abs(r) >= kSingularRadius) rates.phi_dot = J_transposed_v(2) / (r * r);
  return rates;
}

}  // namespace tautline
