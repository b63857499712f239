#include "control/visual_servo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/tether_geometry.h"

namespace tautline {
namespace {

/// C to W for a camera whose picture stays upright. `azimuth` of the optical axis is atan2(x, z).
Eigen::Quaterniond uprightCamera(double azimuth, double pitch) noexcept {
  return Eigen::AngleAxisd(azimuth - 0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitZ());
}

}  // namespace

TeleopRates VisualServo::update(Time now, const ServoInput& in) noexcept {
  take(now, in);
  TeleopRates rates;
  const std::optional<Eigen::Vector3d> wanted = goal(now);
  if (!wanted || !in.estimate.usable()) return rates;
  RateCommand move;
  if (config_.law == ServoLaw::kTracking) {
    move = tracking(now, in);
  } else {
    const Eigen::Vector3d& p = in.estimate.p_WD;
    move = position_.update({}, {.estimate = in.estimate,
                                 .anchor = in.anchor,
                                 .p_WS = p,
                                 .p_WE = *wanted,
                                 .speed = config_.speed_max_mps,
                                 .limits = in.limits});
  }
  rates.length = move.length_rate;
  rates.elevation = move.elevation_rate;
  rates.azimuth = move.azimuth_rate;
  const LookAtRates look =
      lookAt(config_.look_at, in.limits, in.estimate.p_WD, target_->p_WM, in.R_WB, in.gimbal_pitch);
  rates.yaw = look.yaw_rate;
  rates.gimbal_pitch = look.gimbal_pitch_rate;
  return rates;
}

std::optional<Eigen::Vector3d> VisualServo::goal(Time now) const noexcept {
  if (!target_ || toSeconds(now - target_->taken) > config_.lost_after_s) return std::nullopt;
  const double ahead = config_.law == ServoLaw::kTracking ? toSeconds(now - target_->taken) : 0.0;
  return target_->p_WM + ahead * target_->v_WM + config_.standoff_m * target_->normal_W;
}

/// (C14): the picture was taken where the drone was then; the target's velocity is an alpha-beta
/// filter's, critically damped over track_time_s.
void VisualServo::take(Time now, const ServoInput& in) noexcept {
  if (!in.sighting || !in.R_WB || !in.gimbal_pitch || !in.estimate.usable()) return;
  const Sighting& s = *in.sighting;
  if (target_ && s.taken <= target_->taken) return;
  const std::optional<double> heading = headingOf(*in.R_WB);
  const double age = toSeconds(now - s.taken);
  if (!heading || age < 0.0 || age > config_.lost_after_s || !s.p_CM.allFinite()) return;
  if (!s.normal_C.allFinite() || s.normal_C.squaredNorm() < 0.25) return;
  const Eigen::Quaterniond R_WC = uprightCamera(*heading, *in.gimbal_pitch);
  const bool tracks = config_.law == ServoLaw::kTracking;
  const Eigen::Vector3d p_WC =
      tracks ? Eigen::Vector3d(in.estimate.p_WD - age * in.estimate.v_WD) : in.estimate.p_WD;
  const Eigen::Vector3d p_WM = p_WC + R_WC * s.p_CM;
  const Eigen::Vector3d normal_W = R_WC * s.normal_C;
  const double dt = target_ ? toSeconds(s.taken - target_->taken) : config_.lost_after_s;
  if (!tracks || dt >= config_.lost_after_s) {
    target_ = Target{s.taken, p_WM, Eigen::Vector3d::Zero(), normal_W.normalized()};
    return;
  }
  const double keep = std::exp(-dt / config_.track_time_s);
  const double alpha = 1.0 - keep * keep;
  const double beta = (1.0 - keep) * (1.0 - keep);
  const Eigen::Vector3d predicted = target_->p_WM + dt * target_->v_WM;
  const Eigen::Vector3d innovation = p_WM - predicted;
  target_->p_WM = predicted + alpha * innovation;
  target_->v_WM += beta / dt * innovation;
  target_->normal_W = (keep * target_->normal_W + (1.0 - keep) * normal_W).normalized();
  target_->taken = s.taken;
}

/// (C15), (C16)
RateCommand VisualServo::tracking(Time now, const ServoInput& in) const noexcept {
  const Eigen::Vector3d error = *goal(now) - in.estimate.p_WD;
  Eigen::Vector3d v = target_->v_WM + config_.gain_per_s * error;
  v *= std::min(1.0, config_.speed_max_mps / std::max(v.norm(), 1e-9));
  const Eigen::Vector3d p_AD = in.estimate.p_WD - in.anchor.p_WA + config_.vehicle_lag_s * v;
  return scaleTogether(ratesFromVelocity(toTether(p_AD), v), in.limits);
}

}  // namespace tautline
