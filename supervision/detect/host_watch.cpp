#include "supervision/detect/host_watch.h"

#include <cmath>

namespace tautline {
namespace {

bool applies(Required required, RunMode run) noexcept {
  return required == Required::kAlways || (required == Required::kReal && run == RunMode::kReal);
}

}  // namespace

void HostWatch::update(Time now, bool on_ground, const HostFacts& facts, Findings& out) noexcept {
  if (!first_) {
    first_ = now;
    unix_offset_ = facts.unix_offset;
  }
  const double dt = last_ ? toSeconds(now - *last_) : 0.0;
  const double step = std::abs(toSeconds(facts.unix_offset - unix_offset_));
  last_ = now;
  unix_offset_ = facts.unix_offset;
  lateness_ +=
      (1.0 - std::exp(-dt / config_.lateness_time_s)) * (toSeconds(facts.lateness) - lateness_);
  out.reportAbove(Condition::kLoopJitter, lateness_, config_.max_lateness_s);
  out.reportAbove(Condition::kClockJump, step, config_.clock_step_s);
  out.reportAbove(Condition::kClockJump, dt, config_.max_cycle_s);
  const bool unsynchronized = !facts.clock_synchronized && on_ground;
  out.report(Condition::kClockJump,
             unsynchronized && applies(config_.synchronized_clock, facts.run_mode), dt,
             config_.max_cycle_s);

  out.report(Condition::kRealTimeMissing,
             !facts.real_time && applies(config_.real_time, facts.run_mode));
  const Time heard = facts.recorder ? facts.recorder->heard : *first_;
  const double silence = toSeconds(now - heard);
  const bool writes = facts.recorder && facts.recorder->recording;
  out.report(Condition::kLogOff,
             applies(config_.log, facts.run_mode) && (!writes || silence > config_.log_silence_s),
             silence, config_.log_silence_s);
  if (facts.recorder) {
    out.reportBelow(Condition::kDiskLow, static_cast<double>(facts.recorder->disk_free),
                    static_cast<double>(facts.recorder->disk_limit));
  }
  const bool real_run = facts.run_mode == RunMode::kReal;
  out.report(Condition::kSimMismatch,
             facts.device == (real_run ? DeviceReality::kEmulated : DeviceReality::kReal));
}

}  // namespace tautline
