#include "estimation/localizer.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/catenary.h"

namespace tautline {
namespace {

bool isFinite(const Anchor& anchor) noexcept {
  return anchor.p_WA.allFinite() && std::isfinite(anchor.L_static);
}

bool isSame(const Anchor& a, const Anchor& b) noexcept {
  return a.p_WA == b.p_WA && a.L_static == b.L_static && a.contact_count == b.contact_count;
}

TetherRates commandedRates(const VehicleCommand& command) noexcept {
  if (!command.engaged) return {};
  const auto finite = [](double rate) { return std::isfinite(rate) ? rate : 0.0; };
  return {.L_dot = finite(command.length_rate),
          .theta_dot = finite(command.elevation_rate),
          .phi_dot = finite(command.azimuth_rate)};
}

// How many times less than a fresh one a reading says whose error lasts for `correlation_time`.
double noiseWeight(double correlation_time, double period) noexcept {
  return period > 0.0 ? std::max(1.0, 2.0 * correlation_time / period) : 1.0;
}

double largestSigma(const Eigen::Matrix3d& P) noexcept {
  return std::sqrt(std::max(0.0, P.diagonal().maxCoeff()));
}

}  // namespace

Localizer::Localizer(const LocalizerConfig& config)
    : config_(config),
      fix_variant_(fixOf(config.variant)),
      monitor_(config.sensors),
      filter_(config) {}

void Localizer::reset(const Eigen::Vector3d& p_WD0, Time now) noexcept {
  const Eigen::Vector3d p = p_WD0.allFinite() ? p_WD0 : Eigen::Vector3d::Zero();
  filter_.reset(p);
  fix_ = Estimate{};
  fix_.p_WD = p;
  fix_failed_ = false;
  on_ground_ = true;
  at_home_ = true;
  parked_length_.reset();
  ready_ = true;
  nis_ = 1.0;
  last_update_ = now;
}

Estimate Localizer::update(Time now, const SensorFrame& frame, const VehicleCommand& last_command,
                           const Anchor& anchor) noexcept {
  const double dt = last_update_ && now > *last_update_ ? toSeconds(now - *last_update_) : 0.0;
  last_update_ = last_update_ ? std::max(*last_update_, now) : now;
  sensor_health_ = monitor_.update(now, frame, last_command);
  updateAnchor(anchor);
  updateGroundContact(now, frame, last_command);
  const bool memoryless = fix_variant_ && !on_ground_;
  if (!fix_variant_ && !on_ground_) filter_.predict(dt, commandedRates(last_command), anchor_);
  useSamples(now, frame);
  if (memoryless) updateFix(now, frame);

  Estimate estimate = memoryless ? fix_ : filterEstimate();
  estimate.valid = ready_;
  estimate.health = health(now, frame, estimate);
  return estimate;
}

void Localizer::updateAnchor(const Anchor& anchor) noexcept {
  if (!isFinite(anchor) || isSame(anchor, anchor_)) return;
  anchor_ = anchor;
  // The readings now refer to a point that is known less well: let them move the estimate.
  filter_.addPositionUncertainty(config_.prior.contact_sigma_m);
}

void Localizer::updateGroundContact(Time now, const SensorFrame& frame,
                                    const VehicleCommand& command) noexcept {
  const VehiclePhase phase =
      frame.vehicle.valid ? frame.vehicle.value.phase : VehiclePhase::kUnknown;
  const bool says_flying = phase == VehiclePhase::kFlying || phase == VehiclePhase::kLanding;
  const bool silent_but_steered = phase == VehiclePhase::kUnknown && command.engaged;
  if (on_ground_ && (says_flying || silent_but_steered)) {
    on_ground_ = false;
    if (parked_length_) static_cast<void>(filter_.updateParkedLength(*parked_length_, anchor_));
    at_home_ = false;
    parked_length_.reset();
    filter_.restart(filter_.p(), config_.prior.takeoff_position_sigma_m,
                    config_.prior.takeoff_velocity_sigma_mps);
    for (Stream* stream : {&reel_, &angles_}) {
      stream->accepted = now;
      stream->refused = 0;
      stream->first_refused.reset();
    }
  } else if (!on_ground_ && phase == VehiclePhase::kIdle) {
    on_ground_ = true;
    const Eigen::Vector3d p = fix_variant_ ? fix_.p_WD : filter_.p();
    const double sigma = largestSigma(filter_.P().topLeftCorner<3, 3>());
    filter_.restart(p, std::max(sigma, config_.prior.position_sigma_m), 0.0);
    nis_ = 1.0;
  }
}

template <class T>
std::optional<Localizer::NewSample> Localizer::take(Stream& stream, SensorStream which, Time now,
                                                    const Sample<T>& sample,
                                                    bool plausible) noexcept {
  if (sample.sequence == stream.sequence) return std::nullopt;
  stream.sequence = sample.sequence;
  const double age = std::max(0.0, toSeconds(now - sample.time));
  const bool late = stream.used && sample.time <= *stream.used;
  if (!sample.valid || !plausible || late || age > config_.sensors.stale_max_s) return std::nullopt;
  const double period =
      stream.used ? toSeconds(sample.time - *stream.used) : sensor_health_[which].period;
  stream.used = sample.time;
  return NewSample{.age = age, .period = period};
}

void Localizer::useSamples(Time now, const SensorFrame& frame) noexcept {
  const LocalizerNoiseConfig& noise = config_.noise;
  // Readings that contradict one another are not used: noise that the gate lets through by chance
  // would teach scale and biases.
  const auto reel = take(reel_, SensorStream::kReel, now, frame.reel,
                         isPlausible(frame.reel.value, config_.sensors.max_length_m) &&
                             !sensor_health_[SensorStream::kReel].jumped());
  const auto angles =
      take(angles_, SensorStream::kAngles, now, frame.angles,
           isPlausible(frame.angles.value) && !sensor_health_[SensorStream::kAngles].jumped());
  const auto attitude = take(attitude_, SensorStream::kAttitude, now, frame.attitude,
                             isPlausible(frame.attitude.value));
  const bool parked = frame.vehicle.valid && frame.vehicle.value.phase == VehiclePhase::kIdle;
  if (reel && at_home_ && parked) parked_length_ = frame.reel.value.length;
  if (on_ground_ || fix_variant_)
    return;  // taken, so that they are not mistaken for new ones later

  if (reel) {
    judge(reel_, now,
          filter_.updateLength(frame.reel.value.length, reel->age,
                               noiseWeight(noise.correlation_time_s, reel->period), anchor_));
  }
  if (angles) {
    const TetherAngles& value = frame.angles.value;
    judge(angles_, now,
          filter_.updateAngles(value.theta, value.phi, angles->age,
                               noiseWeight(noise.correlation_time_s, angles->period), anchor_));
    if (noise.use_altitude && value.altitude) {
      static_cast<void>(filter_.updateAltitude(
          *value.altitude, angles->age,
          noiseWeight(noise.altitude_correlation_time_s, angles->period), anchor_));
    }
  }
  if (attitude) {
    static_cast<void>(filter_.updateLean(
        frame.attitude.value.R_WB, attitude->age,
        noiseWeight(noise.tension_correlation_time_s, attitude->period), anchor_));
  }
  if (reel && frame.reel.value.tension) {
    static_cast<void>(filter_.updateReelTension(
        *frame.reel.value.tension, reel->age,
        noiseWeight(noise.tension_correlation_time_s, reel->period), anchor_));
  }
}

void Localizer::judge(Stream& stream, Time now, const Innovation& innovation) noexcept {
  constexpr double kLowPass = 0.2;  // about the last five readings
  const double gate = config_.health.innovation_gate;
  nis_ += kLowPass * (std::min(innovation.nis, gate * gate) - nis_);
  if (innovation.accepted) {
    stream.accepted = now;
    stream.refused = 0;
    stream.first_refused.reset();
    return;
  }
  if (!stream.first_refused) stream.first_refused = now;
  ++stream.refused;
  if (stream.refused >= config_.health.reacquire_after &&
      toSeconds(now - *stream.first_refused) >= config_.health.reacquire_time_s) {
    filter_.addPositionUncertainty(config_.health.reacquire_sigma_m);
    stream.refused = 0;
    stream.first_refused.reset();
  }
}

TensionEstimate Localizer::memorylessTension(const SensorFrame& frame, double L,
                                             double theta) const noexcept {
  const double w = config_.tether_weight_n_per_m;
  const double nominal = config_.nominal_tension_n;
  TensionPrior prior{.T = nominal, .sigma = nominal * config_.process.tension_sigma};
  if (frame.reel.value.tension && anchor_.contact_count == 0) {
    const ReelTension carried = tensionFromReel(*frame.reel.value.tension, L, theta, w);
    if (carried.ok)
      prior = {.T = carried.T_D, .sigma = carried.T_D * config_.noise.reel_tension_sigma};
  }
  const double T_lower =
      kTensionMargin * minimumTension(L * std::cos(theta), L * std::sin(theta), w);
  const bool lean = sensor_health_[SensorStream::kAttitude].ok();
  if (!lean) return {.T = std::max(prior.T, T_lower), .sigma = prior.sigma};
  return mapTension(thrustElevation(frame.attitude.value.R_WB), config_.noise.lean_sigma_rad, theta,
                    config_.vehicle_weight_n, prior, T_lower);
}

void Localizer::updateFix(Time now, const SensorFrame& frame) noexcept {
  const bool usable = frame.reel.valid && frame.angles.valid &&
                      isPlausible(frame.reel.value, config_.sensors.max_length_m) &&
                      isPlausible(frame.angles.value);
  if (!usable) {
    fix_failed_ = true;
    return;
  }
  constexpr double kHalfPi = std::numbers::pi / 2.0;
  const double L = std::max(0.0, frame.reel.value.length - anchor_.L_static);
  const double theta = std::clamp(frame.angles.value.theta, -kHalfPi, kHalfPi);
  TensionEstimate tension;
  if (*fix_variant_ == FixVariant::kAsPublishedText) {
    const double beta = thrustElevation(frame.attitude.value.R_WB);
    tension.T = forcesFromLean(beta, theta, config_.vehicle_weight_n).T;
  } else {
    tension = memorylessTension(frame, L, theta);
  }
  const PositionFix fix = fixPosition(*fix_variant_, {.L = L,
                                                      .theta = theta,
                                                      .phi = frame.angles.value.phi,
                                                      .T = tension.T,
                                                      .w = config_.tether_weight_n_per_m});
  fix_failed_ = !fix.ok;
  if (!fix.ok) return;
  reel_.accepted = frame.reel.time;
  angles_.accepted = std::min(now, frame.angles.time);
  fix_.p_WD = anchor_.p_WA + fix.p_AD;
  fix_.L_free = L;
  fix_.theta_tangent = theta;
  fix_.phi = wrapAngle(frame.angles.value.phi);
  fix_.T = tension.T;
  fix_.sigma_T = tension.sigma;
  const Eigen::Vector3d sigmas(
      std::hypot(config_.noise.length_sigma_m, L * config_.prior.reel_scale_sigma),
      std::hypot(config_.noise.elevation_sigma_rad, config_.prior.elevation_bias_sigma_rad),
      std::hypot(config_.noise.azimuth_sigma_rad, config_.prior.azimuth_zero_sigma_rad));
  const Eigen::Matrix3d J = jacobian({L, theta, frame.angles.value.phi}) * sigmas.asDiagonal();
  fix_.P_position = J * J.transpose();
}

Estimate Localizer::filterEstimate() const noexcept {
  const TetherFilter::Covariance& P = filter_.P();
  const auto sigma = [&](int i) { return std::sqrt(std::max(0.0, P(i, i))); };
  const TetherSegment segment =
      segmentTo(filter_.p() - anchor_.p_WA, filter_.T(), config_.tether_weight_n_per_m);
  Estimate out;
  out.p_WD = filter_.p();
  if (!on_ground_) out.v_WD = filter_.v();
  // Contacts are where the plan says, but for an error that no number of readings relative to them
  // averages out.
  const double contact = config_.prior.contact_sigma_m;
  out.P_position = P.topLeftCorner<3, 3>();
  out.P_position.diagonal().array() += anchor_.contact_count * contact * contact;
  out.L_free = segment.L;
  out.theta_tangent = segment.theta_D;
  out.phi = segment.phi;
  out.T = segment.T;
  out.sigma_T = out.T * sigma(TetherFilter::kLogT);
  out.reel_scale = filter_.x()(TetherFilter::kScale);
  out.sigma_reel_scale = sigma(TetherFilter::kScale);
  out.elevation_bias = filter_.x()(TetherFilter::kElevationBias);
  out.azimuth_zero = filter_.x()(TetherFilter::kAzimuthZero);
  out.nis = nis_;
  return out;
}

EstimateHealth Localizer::health(Time now, const SensorFrame& frame,
                                 const Estimate& estimate) const noexcept {
  if (!ready_) return EstimateHealth::kLost;
  const LocalizerHealthConfig& limits = config_.health;
  const StreamHealth& reel = sensor_health_[SensorStream::kReel];
  const StreamHealth& angles = sensor_health_[SensorStream::kAngles];
  const bool sensed = reel.ok() && angles.ok();
  if (on_ground_) return sensed ? EstimateHealth::kOk : EstimateHealth::kDegraded;

  const auto silent = [&](const Stream& stream, const StreamHealth& stream_health) {
    return toSeconds(now - stream.accepted) > limits.lost_factor * stream_health.stale_after;
  };
  const double sigma_p = largestSigma(estimate.P_position);
  if (silent(reel_, reel) || silent(angles_, angles)) return EstimateHealth::kLost;
  if (sigma_p > limits.lost_position_sigma_m || estimate.nis > limits.lost_nis) {
    return EstimateHealth::kLost;
  }
  const bool tension_known = sensor_health_[SensorStream::kAttitude].ok() ||
                             (reel.ok() && frame.reel.value.tension.has_value());
  const bool degraded = !sensed || !tension_known || fix_failed_ ||
                        sigma_p > limits.degraded_position_sigma_m ||
                        estimate.nis > limits.degraded_nis;
  return degraded ? EstimateHealth::kDegraded : EstimateHealth::kOk;
}

}  // namespace tautline
