#include "supervision/detect/tether_watch.h"

#include <algorithm>
#include <cmath>

#include "common/catenary.h"
#include "common/tether_geometry.h"

namespace tautline {
namespace {

constexpr double kLeastTension =
    0.02;  // [N] the shape of a tether without any tension is not defined

}  // namespace

void TetherWatch::update(Time now, const TetherWatchInput& in, Findings& out) noexcept {
  const double dt = last_ && now > *last_ ? toSeconds(now - *last_) : 0.0;
  last_ = now;
  const double L_end = in.L_max - config_.reel_margin_m;
  out.reportAbove(Condition::kReelLimit, in.L_total, L_end);
  if (!in.flying) {
    flying_since_.reset();
    before_.reset();
    has_pulled_ = false;
    commanded_.setZero();
    moved_.setZero();
    return;
  }
  if (!flying_since_) flying_since_ = now;
  const bool settled = toSeconds(now - *flying_since_) >= config_.settle_s;
  out.reportBelow(Condition::kTensionUnobservable, std::sin(in.lean_angle),
                  std::sin(config_.least_lean_angle_rad));
  out.reportAbove(Condition::kElevationHigh, in.theta, config_.elevation_high_rad);

  // The reel's own sensor carried to the drone, eq. (11), or else the drone's lean, eq. (4).
  std::optional<double> T = in.T_lean;
  std::optional<double> T_most = in.T_lean;
  if (T_most) *T_most += in.T_lean_error;
  if (in.T_reel) {
    const ReelTension carried = tensionFromReel(*in.T_reel, in.L_free, in.theta, in.w);
    T = T_most = carried.ok ? carried.T_D : *in.T_reel;
  }
  const double hardest = std::max(in.T_reel.value_or(0.0), in.T_lean.value_or(0.0));
  out.report(Condition::kOverTension, settled && hardest > config_.max_tension_n, hardest,
             config_.max_tension_n);
  watchSnag(dt, in, T, out);
  if (settled) {
    watchSlack(in, T_most, out);
    watchBreak(now, in, T, out);
  }
  before_ = in;
}

/// (D1)
void TetherWatch::watchSlack(const TetherWatchInput& in, std::optional<double> T_most,
                             Findings& out) const noexcept {
  if (!T_most) return;
  const CatenarySolution hangs = solveCatenary(
      {.L = in.L_free, .theta_D = in.theta, .T_D = std::max(*T_most, kLeastTension), .w = in.w});
  if (!hangs.ok) return;
  out.reportAbove(Condition::kTetherSlack, in.L_free - hangs.chord,
                  config_.slack_excess_m + config_.slack_fraction * in.L_free);
}

/// (D3)
void TetherWatch::watchSnag(double dt, const TetherWatchInput& in, std::optional<double> T,
                            Findings& out) noexcept {
  const double across = in.L_free * std::cos(in.theta);
  const double kept = std::exp(-dt / config_.snag_window_s);
  commanded_ = kept * commanded_ +
               dt * Motion(in.length_rate, in.L_free * in.elevation_rate, across * in.azimuth_rate);
  moved_ *= kept;
  if (before_) {
    moved_ += Motion(in.L_total - before_->L_total, in.L_free * (in.theta - before_->theta),
                     across * wrapAngle(in.phi - before_->phi));
  }
  // Motion along what was commanded; near the pole the vehicle's set-point ends by itself.
  const double wanted = commanded_.norm();
  const double came = wanted > 0.0 ? moved_.dot(commanded_) / wanted : 0.0;
  const bool still = in.theta < config_.elevation_high_rad && wanted > config_.snag_motion_m &&
                     came < config_.snag_fraction * wanted;
  const double pull = std::max(T.value_or(0.0), in.T_reel.value_or(0.0));
  out.report(Condition::kTetherSnagged, still && pull > config_.snag_tension_n, pull,
             config_.snag_tension_n);
}

/// (D4)
void TetherWatch::watchBreak(Time now, const TetherWatchInput& in, std::optional<double> T,
                             Findings& out) noexcept {
  if (!T || *T >= config_.broken_tension_n) {
    // A pull that cannot be seen does not count as gone.
    has_pulled_ = has_pulled_ || T.has_value();
    pulled_ = now;
    pulled_length_ = in.L_total;
  }
  const bool gone = has_pulled_ && toSeconds(now - pulled_) > config_.broken_time_s;
  const bool unexplained = in.L_total - pulled_length_ < config_.broken_pay_out_m;
  out.report(Condition::kTetherBroken, gone && unexplained, T.value_or(0.0),
             config_.broken_tension_n);
}

}  // namespace tautline
