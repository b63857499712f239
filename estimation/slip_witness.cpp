#include "estimation/slip_witness.h"

#include <algorithm>
#include <cmath>

#include "estimation/evidence.h"

namespace tautline {
namespace {

constexpr int kDirections = 2;

}  // namespace

SlipWitness::SlipWitness(const SlipWitnessConfig& config) noexcept
    : config_(config),
      threshold_(
          evidenceThreshold(kDirections, config.correlation_time_s, config.false_alarms_per_hour)),
      up_{.step = config.slip_m},
      down_{.step = -config.slip_m} {}

void SlipWitness::restart() noexcept {
  began_.reset();
  up_ = {.step = config_.slip_m};
  down_ = {.step = -config_.slip_m};
  evidence_ = slip_ = 0.0;
}

void SlipWitness::update(Time now, std::uint32_t sequence, double residual) noexcept {
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
  const double over = residual - mean_;
  if (slipped()) {  // What has slipped is not drift: the mean stays.
    slip_ += -std::expm1(-dt / config_.settle_s) * (over - slip_);
    return;
  }
  if (since >= config_.settle_s) {
    // The mean is of so many independent readings, and no better than they.
    const double averaged = std::min(since, config_.mean_time_s);
    const double variance =
        config_.sigma_m * config_.sigma_m * (1.0 + config_.correlation_time_s / averaged);
    add(up_, dt, over, variance);
    add(down_, dt, over, variance);
  }
  const Sum& most = up_.evidence >= down_.evidence ? up_ : down_;
  evidence_ = most.evidence / threshold_;
  slip_ = most.mean;
  // The plain mean until it is as old as it may become.
  mean_ += dt / std::min(since, std::max(config_.mean_time_s, dt)) * over;
}

void SlipWitness::add(Sum& sum, double dt, double residual, double variance) const noexcept {
  const double samples = std::min(1.0, dt / config_.correlation_time_s);
  const double ratio = samples * (sum.step * residual - 0.5 * sum.step * sum.step) / variance;
  const double keep = std::exp(-dt / config_.memory_s);
  sum.evidence = std::max(0.0, keep * sum.evidence + ratio);
  if (sum.evidence == 0.0) {
    sum.time = sum.mean = 0.0;
    return;
  }
  sum.time += dt;
  sum.mean += dt / sum.time * (residual - sum.mean);
}

}  // namespace tautline
