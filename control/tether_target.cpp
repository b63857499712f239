#include "control/tether_target.h"

#include <cmath>

#include "common/catenary.h"

namespace tautline {

TetherTarget tetherTarget(const TetherModelConfig& config, const Eigen::Vector3d& p_AD,
                          double T) noexcept {
  TetherTarget out;
  if (!p_AD.allFinite()) return out;
  out.q = toTether(p_AD);
  if (config.model == TetherModel::kStraight) {
    out.reachable = true;
    return out;
  }
  const CatenaryInverse sag =
      solveInverseCatenary(std::hypot(p_AD.x(), p_AD.z()), p_AD.y(),
                           T > 0.0 ? T : config.nominal_tension_n, config.weight_n_per_m);
  if (!sag) return out;
  out.reachable = true;
  out.q.L = sag.L;
  out.q.theta = sag.theta_D;
  return out;
}

}  // namespace tautline
