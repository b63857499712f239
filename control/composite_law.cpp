#include "control/composite_law.h"

#include <algorithm>
#include <cmath>

#include "control/segment.h"

namespace tautline {
namespace {

/// Look-ahead point on the path, relative to A.
struct Carrot {
  Eigen::Vector3d p_AG{Eigen::Vector3d::Zero()};  ///< [m]
  Eigen::Vector3d heading{
      Eigen::Vector3d::Zero()};  ///< Unit path direction there; zero at a point to stop at.
};

/// Eq. (C3): the closest point of the segment moved on by `look_ahead` [m], round the corner into
/// the next segment.
Carrot lookAhead(const ControlInput& in, double look_ahead) noexcept {
  const SegmentProgress here = projectOnSegment(in.estimate.p_WD, in.p_WS, in.p_WE);
  const double s = std::clamp(here.along, 0.0, here.length) + look_ahead;
  if (s <= here.length) {
    return {.p_AG = in.p_WS + s * here.direction - in.anchor.p_WA, .heading = here.direction};
  }
  if (!in.p_WN) return {.p_AG = in.p_WE - in.anchor.p_WA};
  const SegmentProgress next = projectOnSegment(in.p_WE, in.p_WE, *in.p_WN);
  const double beyond = std::min(s - here.length, next.length);
  return {.p_AG = in.p_WE + beyond * next.direction - in.anchor.p_WA,
          .heading = next.length > 0.0 ? next.direction : here.direction};
}

/// Velocity towards `goal`, without a direction to be had at the goal itself.
Eigen::Vector3d towards(const Eigen::Vector3d& p, const Eigen::Vector3d& goal,
                        double speed) noexcept {
  constexpr double kThere = 1e-9;  // [m]
  const double distance = (goal - p).norm();
  return distance > kThere ? Eigen::Vector3d((goal - p) * (speed / distance))
                           : Eigen::Vector3d::Zero();
}

/// Rates for velocity v by the exact sag: difference of two inverse catenaries a little along v.
/// Straight where the sag model has no answer.
TetherRates feedForward(const TetherModelConfig& model, const Eigen::Vector3d& p_AD,
                        const Eigen::Vector3d& v, double T) noexcept {
  const TetherRates straight = ratesFromVelocity(toTether(p_AD), v);
  if (model.model == TetherModel::kStraight) return straight;
  constexpr double kStep = 0.01;  // [s]
  const TetherTarget before = tetherTarget(model, p_AD - kStep * v, T);
  const TetherTarget after = tetherTarget(model, p_AD + kStep * v, T);
  if (!before.reachable || !after.reachable) return straight;
  return {.L_dot = (after.q.L - before.q.L) / (2.0 * kStep),
          .theta_dot = (after.q.theta - before.q.theta) / (2.0 * kStep),
          .phi_dot = straight.phi_dot};
}

}  // namespace

void CompositeLaw::reset() noexcept {
  detour_.reset();
  chart_.reset();
  last_ = RateCommand{};
}

RateCommand CompositeLaw::update(Duration dt, const ControlInput& in) noexcept {
  if (!isUsable(in)) {
    last_ = RateCommand{};
    return last_;
  }
  const Eigen::Vector3d p_AD = in.estimate.p_WD - in.anchor.p_WA;
  const Eigen::Vector3d p_AE = in.p_WE - in.anchor.p_WA;
  const Carrot carrot =
      lookAhead(in, std::max(config_.look_ahead_min_m, config_.look_ahead_s * in.speed));
  const auto speedBeforeStop = [&](const Eigen::Vector3d& stop) {
    return in.p_WN ? in.speed : std::min(in.speed, config_.stop_gain_per_s * (stop - p_AD).norm());
  };

  // The rates take effect only after the vehicle's lag: they are those of where the drone will be
  // then.
  TetherRates u;
  if (config_.pole_strategy == PoleStrategy::kUnwrapped) {
    const Eigen::Vector3d v = towards(p_AD, carrot.p_AG, speedBeforeStop(p_AE));
    const Eigen::Matrix3d& P = in.estimate.P_position;
    const double sigma = std::sqrt(std::max(0.0, 0.5 * (P(0, 0) + P(2, 2))));
    chart_.follow(toSeconds(dt), p_AD + config_.vehicle_lag_s * v, last_.azimuth_rate,
                  std::max(config_.chart_damping_m, 3.0 * sigma));
    u = chart_.rates(v);
  } else {
    const PoleCylinder pole = poleCylinder(config_.pole, in.limits);
    const bool ends_inside = !in.p_WN && axisDistance(p_AE) < pole.radius;
    const Eigen::Vector3d no_way_on = Eigen::Vector3d::Zero();
    const Eigen::Vector3d goal =
        PoleDetour::outsideGoal(pole, p_AD, carrot.p_AG, ends_inside ? no_way_on : carrot.heading);
    const Eigen::Vector3d stop = PoleDetour::outsideGoal(pole, p_AD, p_AE, no_way_on);
    const Eigen::Vector3d v = detour_.steer(pole, p_AD, goal, speedBeforeStop(stop));
    u = feedForward(config_.feed_forward, p_AD + config_.vehicle_lag_s * v, v, in.estimate.T);
  }
  last_ = scaleTogether(u, in.limits);
  return last_;
}

}  // namespace tautline
