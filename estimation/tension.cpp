#include "estimation/tension.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/tether_geometry.h"

namespace tautline {
namespace {

// R_WB e_up for any quaternion but zero; level for that one and for non-finite ones.
Eigen::Vector3d thrustAxis(const Eigen::Quaterniond& R_WB) noexcept {
  const double norm = R_WB.norm();
  if (!std::isfinite(norm) || norm <= 0.0) return Eigen::Vector3d::UnitY();
  const Eigen::Quaterniond unit(R_WB.coeffs() / norm);
  return unit * Eigen::Vector3d::UnitY();
}

}  // namespace

double thrustElevation(const Eigen::Quaterniond& R_WB) noexcept {
  const Eigen::Vector3d n = thrustAxis(R_WB);
  return std::atan2(n.y(), std::hypot(n.x(), n.z()));  // asin(n_y), with all digits near level
}

double thrustElevationInPlane(const Eigen::Quaterniond& R_WB, double phi) noexcept {
  const Eigen::Vector3d n = thrustAxis(R_WB);
  return std::atan2(n.y(), n.x() * std::sin(phi) + n.z() * std::cos(phi));
}

LeanForces forcesFromLean(double beta, double theta, double G) noexcept {
  const double s = std::sin(beta - theta);
  const double c = std::cos(beta);
  if (!(s > 0.0) || !(c > 0.0) || !(G > 0.0)) return {};
  const LeanForces out{.ok = true, .T = G * c / s, .F = G * std::cos(theta) / s};  // (4)
  return std::isfinite(out.T) && std::isfinite(out.F) ? out : LeanForces{};
}

double relativeTensionSensitivity(double T, double theta, double G) noexcept {
  return -(G / T + 2.0 * std::sin(theta) + T / G) / std::cos(theta);
}

LeanModel leanModel(double T, double theta, double G) noexcept {
  const double s = std::sin(theta);
  const double c = std::cos(theta);
  const double F2 = G * G + 2.0 * G * T * s + T * T;
  return {.beta = std::atan2(G + T * s, T * c),  // (12)
          .dbeta_dT = -G * c / F2,
          .dbeta_dtheta = T * (T + G * s) / F2};
}

TensionEstimate mapTension(double beta, double sigma_beta, double theta, double G,
                           const TensionPrior& prior, double T_lower) noexcept {
  TensionEstimate out{.T = std::max(prior.T, T_lower), .sigma = prior.sigma};
  if (!std::isfinite(beta) || !std::isfinite(theta) || !(sigma_beta > 0.0)) return out;

  const auto cost = [&](double T) {  // (13)
    const double lean = wrapAngle(beta - leanModel(T, theta, G).beta) / sigma_beta;
    const double tension = (T - prior.T) / prior.sigma;
    return lean * lean + tension * tension;
  };
  constexpr int kMaxSteps = 30;
  constexpr int kMaxHalvings = 30;
  double best = cost(out.T);
  for (int i = 0; i < kMaxSteps; ++i) {
    const LeanModel model = leanModel(out.T, theta, G);
    const double slope = model.dbeta_dT / sigma_beta;
    const double information = slope * slope + 1.0 / (prior.sigma * prior.sigma);
    const double gradient = slope * wrapAngle(beta - model.beta) / sigma_beta -
                            (out.T - prior.T) / (prior.sigma * prior.sigma);
    out.sigma = 1.0 / std::sqrt(information);
    double step = gradient / information;
    double T = std::max(T_lower, out.T + step);
    for (int k = 0; k < kMaxHalvings && cost(T) > best; ++k) {
      step *= 0.5;
      T = std::max(T_lower, out.T + step);
    }
    const double moved = std::abs(T - out.T);
    if (cost(T) > best) break;  // nothing left but rounding
    out.T = T;
    best = cost(T);
    if (moved <= 1e-13 * (1.0 + T)) break;
  }
  return out;
}

}  // namespace tautline
