#include "control/position_law.h"

#include <cmath>

namespace tautline {

RateCommand PositionLaw::update(Duration /*dt*/, const ControlInput& in) noexcept {
  if (!isUsable(in)) return {};
  const Eigen::Vector3d p_AD = in.estimate.p_WD - in.anchor.p_WA;
  const TetherTarget want = tetherTarget(config_.target, in.p_WE - in.anchor.p_WA, in.estimate.T);
  const TetherTarget have = tetherTarget(config_.target, p_AD, in.estimate.T);
  // Error by one model on both sides: comparing an arc with a chord would be a bias.
  const bool exact = want.reachable && have.reachable;
  const TetherCoordinates q_d = exact ? want.q : toTether(in.p_WE - in.anchor.p_WA);
  const TetherCoordinates q = exact ? have.q : toTether(p_AD);

  const TetherRates q_dot =
      config_.damping > 0.0 ? ratesFromVelocity(toTether(p_AD), in.estimate.v_WD) : TetherRates{};
  const TetherRates u{.L_dot = lengthRate(q_d.L - q.L, q_dot.L_dot),
                      .theta_dot = config_.elevation_gain_per_s * (q_d.theta - q.theta) -
                                   config_.damping * q_dot.theta_dot,
                      .phi_dot = config_.azimuth_gain_per_s * wrapAngle(q_d.phi - q.phi) -
                                 config_.damping * q_dot.phi_dot};
  return clampEach(u, in.limits);
}

double PositionLaw::lengthRate(double error, double rate) const noexcept {
  if (config_.length_law == LengthLaw::kBangBang) {
    // Half a step of dead band, or the reel would never rest.
    if (std::abs(error) < 0.5 * config_.bang_bang_step_m) return 0.0;
    return std::copysign(config_.bang_bang_step_m * config_.message_rate_hz, error);
  }
  return config_.length_gain_per_s * error - config_.damping * rate;
}

}  // namespace tautline
