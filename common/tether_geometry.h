#pragma once

/// @file
/// Straight-line tether geometry: polar coordinates (L, theta, phi) of the drone D about the active
/// anchor A, and their Jacobian. Equations (1)-(3) of docs/tether_model.md; dissertation
/// section 5.1.1.
///
///     p_AD_W = L (cos theta sin phi,  sin theta,  cos theta cos phi)                         (1)
///
/// A's axes are those of world W: right-handed, y up. SI units, radians. phi is positive about +y,
/// from z towards x. Everything here is real-time safe: no allocation, no locks, no exceptions.
/// Finite input gives finite output, also on the singular set {L = 0} and {|theta| = 90 deg}, where
/// each function says what it returns.

#include <Eigen/Core>

namespace tautline {

/// q = (L, theta, phi). As a straight line: L is the chord A to D; with the sag model L is the arc
/// length and theta the tangent elevation at D.
struct TetherCoordinates {
  double L{};      ///< [m], >= 0.
  double theta{};  ///< Elevation [rad], in [-pi/2, pi/2], up positive.
  double phi{};    ///< Azimuth [rad], in (-pi, pi].
};

struct TetherRates {
  double L_dot{};      ///< [m/s]
  double theta_dot{};  ///< [rad/s]
  double phi_dot{};    ///< [rad/s]
};

/// Distance from the singular set [m] below which ratesFromVelocity() drops the rates that are not
/// defined there.
inline constexpr double kSingularRadius = 1e-6;

/// `angle` wrapped to (-pi, pi] [rad]; exact for angles already inside.
[[nodiscard]] double wrapAngle(double angle) noexcept;

/// Eq. (2). At p = 0 all zero; on the vertical axis (x = z = 0) phi = 0.
[[nodiscard]] TetherCoordinates toTether(const Eigen::Vector3d& p_AD) noexcept;

/// Eq. (1): p_AD_W [m]. Defined for all finite q, also outside the ranges above.
[[nodiscard]] Eigen::Vector3d toCartesian(const TetherCoordinates& q) noexcept;

/// Eq. (3): J_p_q = d p_AD_W / d(L, theta, phi). Columns are orthogonal with norms 1, |L|, |L cos
/// theta|; det = -L^2 cos theta.
[[nodiscard]] Eigen::Matrix3d jacobian(const TetherCoordinates& q) noexcept;

/// v_AD_W = J_p_q (L_dot, theta_dot, phi_dot) [m/s].
[[nodiscard]] Eigen::Vector3d velocityFromRates(const TetherCoordinates& q,
                                                const TetherRates& rates) noexcept;

/// q_dot = J^-1 v_AD_W by J^-1 = diag(1, 1/L^2, 1/(L cos theta)^2) J^T: no inversion, the singular
/// set is explicit. Where |L cos theta| < kSingularRadius, phi_dot = 0; where |L| <
/// kSingularRadius, theta_dot = 0 too: the part of v that these coordinates cannot express there is
/// dropped.
[[nodiscard]] TetherRates ratesFromVelocity(const TetherCoordinates& q,
                                            const Eigen::Vector3d& v_AD) noexcept;

}  // namespace tautline
