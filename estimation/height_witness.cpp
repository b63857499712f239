#include "estimation/height_witness.h"

#include <algorithm>
#include <cmath>

namespace tautline {

void HeightWitness::restart() noexcept {
  began_.reset();
  residual_ = step_ = samples_ = 0.0;
}

void HeightWitness::update(Time now, std::uint32_t sequence, double residual) noexcept {
  samples_ = 0.0;
  if (!began_) {
    began_ = last_ = now;
    sequence_ = sequence;
    mean_ = residual;
    return;
  }
  if (sequence == sequence_ || now <= last_) return;
  const double dt = toSeconds(now - last_);
  const double since = toSeconds(now - *began_);
  sequence_ = sequence;
  last_ = now;
  residual_ = residual - mean_;
  // The plain mean until it is as old as it may become.
  mean_ += dt / std::min(since, std::max(config_.mean_time_s, dt)) * residual_;
  step_ += -std::expm1(-dt / config_.settle_s) * (residual_ - step_);
  if (since >= config_.settle_s) samples_ = std::min(1.0, dt / config_.correlation_time_s);
}

double HeightWitness::evidenceOf(double step) const noexcept {
  return samples_ * (step * residual_ - 0.5 * step * step) / (config_.sigma_m * config_.sigma_m);
}

}  // namespace tautline
