#include "sim_hil/reel.h"

#include <algorithm>
#include <cmath>

#include "drivers/fotokite_protocol.h"

namespace tautline::sim {

Reel::Reel(const ReelConfig& config, double length) noexcept
    : config_(config), length_(std::clamp(length, config.min_length, config.max_length)) {}

void Reel::command(double counts_per_second) noexcept {
  const double limit = fotokite::kMaxReelRate;
  double rate = std::isnan(counts_per_second) ? 0.0 : std::clamp(counts_per_second, -limit, limit);
  const bool dead = std::abs(rate - fotokite::kDeadZoneCentre) < 0.5 * fotokite::kDeadZoneWidth;
  if (dead) rate = 0.0;
  commanded_ = rate * metresPerCount();
}

void Reel::drive(double metres_per_second) noexcept {
  commanded_ = std::isnan(metres_per_second)
                   ? 0.0
                   : metres_per_second * metresPerCount() / config_.metres_per_count;
}

void Reel::step(double h, double tension) noexcept {
  constexpr double kSlipSpeed = 0.5;  // of a drive that gives way, per newton too much [m/s/N]
  double asked = disturbance_.rate.value_or(wanted());
  if (config_.mode == ReelMode::kTension && !locked_)
    asked += config_.compliance * (tension - config_.tension);
  const double lagged = rate_ + (asked - rate_) * (1.0 - std::exp(-h / std::fmax(config_.lag, h)));
  const double change = config_.max_acceleration * h;
  rate_ = std::clamp(lagged, rate_ - change, rate_ + change);
  if (std::abs(rate_) < 1e-6) rate_ = 0.0;
  const double slip = kSlipSpeed * std::fmax(0.0, tension - config_.slip_tension);
  const double before = length_;
  const double shortest = std::fmax(config_.min_length, disturbance_.min_length);
  const double follows = disturbance_.follows;
  length_ = std::clamp(length_ + h * (follows * rate_ + slip), shortest, config_.max_length);
  stalled_ = disturbance_.min_length > 0.0 && asked < 0.0 && length_ == shortest;
  counted_ += h * (1.0 - follows) * rate_;
  if (slip == 0.0 && follows == 1.0) rate_ = (length_ - before) / h;  // an end stop stops the drum
}

double Reel::turned(double length) const noexcept {
  // d(turned)/d(length) = 1 / (scale (1 - layer length))
  const double k = config_.layer;
  return (k > 0.0 ? -std::log1p(-k * length) / k : length) / config_.scale;
}

std::int64_t Reel::counts() const noexcept {
  const double out = turned(length_ + counted_) - turned(config_.power_on_length);
  return std::llround(std::floor(out / config_.metres_per_count));
}

double Reel::metresPerCount() const noexcept {
  return config_.metres_per_count * config_.scale * (1.0 - config_.layer * length_);
}

double Reel::scale() const noexcept { return length_ / turned(length_); }

}  // namespace tautline::sim
