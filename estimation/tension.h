#pragma once

/// @file
/// Tether tension at the drone from its lean. Equations (4) and (12), (13) of docs/tether_model.md;
/// dissertation sections 5.1.2 and 5.1.3.
///
/// Free body of the hovering drone, in the vertical plane of the tether tangent: thrust F along n
/// at elevation beta above the horizontal (90 deg = level), tether tension T along -theta, weight
/// G. SI units, radians. Everything here is real-time safe: no allocation, no locks, no exceptions.

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tautline {

/// beta = asin(n_y), n = R_WB e_up [rad], in [-pi/2, pi/2]; the dissertation's "lean angle". The
/// quaternion need not have unit norm; a zero or non-finite one gives level (pi/2).
[[nodiscard]] double thrustElevation(const Eigen::Quaterniond& R_WB) noexcept;

/// Elevation of the thrust axis within the vertical plane of azimuth phi [rad], in (-pi, pi]:
/// atan2(n_y, n . e_out) with e_out = (sin phi, 0, cos phi), pointing away from the anchor. Unlike
/// thrustElevation() it has a sign: above pi/2 the drone leans towards the anchor. So noise across
/// and around the vertical averages out instead of looking like tension.
[[nodiscard]] double thrustElevationInPlane(const Eigen::Quaterniond& R_WB, double phi) noexcept;

struct LeanForces {
  bool ok{false};  ///< False: no positive tension explains this lean (sin(beta - theta) <= 0 or cos
                   ///< beta <= 0).
  double T{};      ///< Tether tension at D [N], > 0.
  double F{};      ///< Thrust [N], > 0.
};

/// Eq. (4): T = G cos(beta)/sin(beta - theta), F = G cos(theta)/sin(beta - theta). As published;
/// ill-conditioned near level flight and under a steep tether (see relativeTensionSensitivity()).
[[nodiscard]] LeanForces forcesFromLean(double beta, double theta, double G) noexcept;

/// d(ln T)/d(beta) = -(G/T + 2 sin theta + T/G)/cos theta [1/rad], T > 0; finite also at |theta| =
/// 90 deg in floating point, but then meaningless.
[[nodiscard]] double relativeTensionSensitivity(double T, double theta, double G) noexcept;

/// Eq. (12): the well-conditioned forward model beta = h(T, theta) and its slopes.
struct LeanModel {
  double beta;          ///< atan2(G + T sin theta, T cos theta) [rad]
  double dbeta_dT;      ///< -G cos theta / F^2 [rad/N]
  double dbeta_dtheta;  ///< T (T + G sin theta) / F^2
};
[[nodiscard]] LeanModel leanModel(double T, double theta, double G) noexcept;

struct TensionPrior {
  double T{};      ///< [N]: the reel's tension carried to D, or a nominal one.
  double sigma{};  ///< [N], > 0.
};

struct TensionEstimate {
  double T{};      ///< [N], >= T_lower.
  double sigma{};  ///< Standard deviation [N]; never above the prior's.
};

/// Eq. (13): maximum a posteriori tension, argmin ((beta - h(T, theta))/sigma_beta)^2 + ((T -
/// prior.T)/prior.sigma)^2 over T >= T_lower, by damped Gauss-Newton. T_lower is normally 1.2 T_min
/// of the segment. Where the lean carries no information (steep tether), or beta is not finite, it
/// is the prior's.
[[nodiscard]] TensionEstimate mapTension(double beta, double sigma_beta, double theta, double G,
                                         const TensionPrior& prior, double T_lower = 0.0) noexcept;

/// Factor on T_min below which no tension is believed: at T_min itself the shape of the tether is
/// not stable.
inline constexpr double kTensionMargin = 1.2;

}  // namespace tautline
