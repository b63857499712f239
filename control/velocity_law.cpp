#include "control/velocity_law.h"

#include <algorithm>

namespace tautline {

RateCommand VelocityLaw::update(Duration /*dt*/, const ControlInput& in) noexcept {
  if (!isUsable(in)) return {};
  const Eigen::Vector3d e = in.p_WE - in.estimate.p_WD;
  const double distance = e.norm();
  double speed = config_.speed_mps;
  if (!in.p_WN && config_.stop_distance_m > 0.0) {
    speed *= std::min(1.0, distance / config_.stop_distance_m);
  }
  constexpr double kThere = 1e-9;
  const Eigen::Vector3d v =
      distance > kThere ? Eigen::Vector3d(e * (speed / distance)) : Eigen::Vector3d::Zero();

  TetherCoordinates q = toTether(in.estimate.p_WD - in.anchor.p_WA);
  if (config_.total_length) q.L += in.anchor.L_static;
  return clampEach(ratesFromVelocity(q, v), in.limits);
}

}  // namespace tautline
