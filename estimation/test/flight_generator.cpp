#include "estimation/test/flight_generator.h"

#include <algorithm>
#include <cmath>

#include "common/testing/catenary_oracle.h"

namespace tautline::testing {
namespace {

double quantize(double value, double quantum) {
  return quantum > 0.0 ? quantum * std::round(value / quantum) : value;
}

}  // namespace

FlightGenerator::FlightGenerator(const FlightOptions& options)
    : options_(options),
      random_(options.seed),
      t_(-options.ground_time),
      q_(reference(0.0)),
      T_(options.T_nominal * std::exp(options.tension_sigma * normal())),
      start_height_(truePosition().y()) {}

FlightGenerator::Polar FlightGenerator::reference(double t) const {
  if (!options_.moving) t = 0.0;
  const double lowest = 0.25;
  const double middle = 0.5 * (lowest + options_.steepest);
  const double swing = 0.5 * (options_.steepest - lowest);
  return {.L = 2.4 + 1.1 * std::sin(0.21 * t),
          .theta = middle + swing * std::sin(0.17 * t),
          .phi = 0.6 + 1.0 * std::sin(0.13 * t)};
}

Eigen::Vector3d FlightGenerator::truePosition() const {
  const TetherEnd end = integrateTether(q_.L, q_.theta, T_, options_.w);
  return anchor_.p_WA + Eigen::Vector3d(end.r * std::sin(q_.phi), end.h, end.r * std::cos(q_.phi));
}

void FlightGenerator::step() {
  constexpr double dt = kCycle;
  now_ += fromSeconds(dt);
  t_ += dt;
  command_ = VehicleCommand{};
  const bool flying = t_ > 0.0 && phase_in_flight == VehiclePhase::kFlying;
  if (flying) {
    // A position law on true values, so that disturbances do not carry the drone away; the
    // localizer sees its rates only.
    const Polar now = reference(t_);
    const Polar next = reference(t_ + dt);
    constexpr double kGain = 0.5;
    const Polar rates{.L = (next.L - now.L) / dt + kGain * (now.L - q_.L),
                      .theta = (next.theta - now.theta) / dt + kGain * (now.theta - q_.theta),
                      .phi = (next.phi - now.phi) / dt + kGain * (now.phi - q_.phi)};
    const double across = q_.L * std::max(0.05, std::cos(q_.theta));
    const double keep = std::exp(-dt / options_.velocity_time_constant);
    const double kick = options_.velocity_sigma * std::sqrt(1.0 - keep * keep);
    const Eigen::Vector3d v_cmd(rates.L, q_.L * rates.theta, across * rates.phi);
    v_lagged_ = v_cmd + keep * (v_lagged_ - v_cmd);
    departure_ = keep * departure_ + kick * Eigen::Vector3d(normal(), normal(), normal());
    const Eigen::Vector3d v = v_lagged_ + departure_;
    q_.L += v(0) * dt;
    q_.theta += v(1) / q_.L * dt;
    q_.phi += v(2) / across * dt;
    const double hold = std::exp(-dt / options_.tension_time_constant);
    const double nominal = std::log(options_.T_nominal);
    T_ = std::exp(nominal + hold * (std::log(T_) - nominal) +
                  options_.tension_sigma * std::sqrt(1.0 - hold * hold) * normal());
    command_.engaged = true;
    command_.length_rate = rates.L / options_.reel_scale;
    command_.elevation_rate = rates.theta;
    command_.azimuth_rate = rates.phi;
  }
  if (!silent && now_ >= next_sample_) {
    next_sample_ = now_ + fromSeconds(1.0 / options_.rate);
    sense();
  }
  while (!in_transit_.empty() && now_ >= in_transit_.front().arrival) {
    frame_ = in_transit_.front().frame;
    in_transit_.pop_front();
  }
}

void FlightGenerator::sense() {
  const FlightOptions& o = options_;
  sensed_.reel.value.length =
      std::max(0.0, quantize((q_.L + anchor_.L_static) / o.reel_scale + o.length_sigma * normal(),
                             o.length_quantum));
  const double T_A = T_ - o.w * (truePosition().y() - anchor_.p_WA.y());
  if (o.has_reel_tension) {
    sensed_.reel.value.tension = T_A * (1.0 + o.reel_tension_sigma * normal());
  }
  TetherAngles& angles = sensed_.angles.value;
  constexpr double kVertical = 1.5707963;
  angles.theta =
      std::clamp(quantize(q_.theta + o.elevation_bias + o.angle_sigma * normal(), o.angle_quantum),
                 -kVertical, kVertical);
  angles.phi = quantize(q_.phi + o.azimuth_zero + o.angle_sigma * normal(), o.angle_quantum);
  if (o.has_altitude) {
    angles.altitude =
        truePosition().y() - start_height_ + o.altitude_offset + o.altitude_sigma * normal();
  }
  // Thrust balances weight and tether pull; yaw is arbitrary.
  const double up = o.G + T_ * std::sin(q_.theta);
  const double out = T_ * std::cos(q_.theta);
  const Eigen::Vector3d n =
      Eigen::Vector3d(out * std::sin(q_.phi), up, out * std::cos(q_.phi)).normalized();
  const Eigen::AngleAxisd noise_x(o.lean_sigma * normal(), Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd noise_z(o.lean_sigma * normal(), Eigen::Vector3d::UnitZ());
  sensed_.attitude.value.R_WB = noise_x * noise_z *
                                Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), n) *
                                Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY());
  sensed_.vehicle.value.phase = t_ > 0.0 ? phase_in_flight : VehiclePhase::kIdle;

  const auto stamp = [&](auto& sample) {
    sample.time = now_;
    sample.valid = true;
    ++sample.sequence;
  };
  stamp(sensed_.reel);
  stamp(sensed_.angles);
  stamp(sensed_.vehicle);
  if (o.has_attitude) stamp(sensed_.attitude);
  in_transit_.push_back({now_ + fromSeconds(o.latency), sensed_});
}

}  // namespace tautline::testing
