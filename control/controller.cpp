#include "control/controller.h"

#include <algorithm>
#include <cmath>

namespace tautline {

bool isUsable(const ControlInput& in) noexcept {
  const VehicleLimits& limits = in.limits;
  return in.estimate.valid && in.estimate.health != EstimateHealth::kLost &&
         in.estimate.p_WD.allFinite() && in.estimate.v_WD.allFinite() &&
         in.anchor.p_WA.allFinite() && std::isfinite(in.anchor.L_static) && in.p_WS.allFinite() &&
         in.p_WE.allFinite() && (!in.p_WN || in.p_WN->allFinite()) && in.speed > 0.0 &&
         std::isfinite(in.speed) && limits.length_rate_mps > 0.0 &&
         limits.elevation_rate_radps > 0.0 && limits.azimuth_rate_radps > 0.0;
}

RateCommand clampEach(const TetherRates& u, const VehicleLimits& limits) noexcept {
  if (!std::isfinite(u.L_dot) || !std::isfinite(u.theta_dot) || !std::isfinite(u.phi_dot)) {
    return {};
  }
  const auto clamp = [](double rate, double limit) { return std::clamp(rate, -limit, limit); };
  return {.ok = true,
          .length_rate = clamp(u.L_dot, limits.length_rate_mps),
          .elevation_rate = clamp(u.theta_dot, limits.elevation_rate_radps),
          .azimuth_rate = clamp(u.phi_dot, limits.azimuth_rate_radps)};
}

RateCommand scaleTogether(const TetherRates& u, const VehicleLimits& limits) noexcept {
  if (!std::isfinite(u.L_dot) || !std::isfinite(u.theta_dot) || !std::isfinite(u.phi_dot)) {
    return {};
  }
  const double excess = std::max({1.0, std::abs(u.L_dot) / limits.length_rate_mps,
                                  std::abs(u.theta_dot) / limits.elevation_rate_radps,
                                  std::abs(u.phi_dot) / limits.azimuth_rate_radps});
  return {.ok = true,
          .length_rate = u.L_dot / excess,
          .elevation_rate = u.theta_dot / excess,
          .azimuth_rate = u.phi_dot / excess};
}

}  // namespace tautline
