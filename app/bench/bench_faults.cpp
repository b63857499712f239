#include "app/bench/bench_faults.h"

namespace tautline::bench {

using sim::Fault;
using sim::FaultMode;
using sim::FaultTarget;

FaultOwner ownerOf(const Fault& fault) noexcept {
  const sim::FaultKind* kind = sim::findFaultKind(fault.target, fault.mode);
  if (kind == nullptr) return {.bench = true, .machine = true};
  const bool bench = kind->place == sim::FaultPlace::kBench;
  return {.bench = bench, .machine = !bench};
}

void BenchFaults::update(Time now) noexcept {
  faults_.update(now);
  const auto cut = [this](FaultTarget target, sim::LooseContact& contact) {
    const bool open = contact.open(faults_.active(target, FaultMode::kIntermittent), faults_);
    return open || faults_.active(target, FaultMode::kOff) != nullptr;
  };
  lcm_cut_ = cut(FaultTarget::kLcm, lcm_contact_);
  operator_cut_ = cut(FaultTarget::kOperatorLink, operator_contact_) || lcm_cut_;
  const Fault* jump = faults_.active(FaultTarget::kLoop, FaultMode::kWrong);
  if (jump != nullptr && !jumped_) clock_ahead_ += fromSeconds(jump->value);
  jumped_ = jump != nullptr;
}

Duration BenchFaults::lateness() const noexcept {
  const Fault* late = faults_.active(FaultTarget::kLoop, FaultMode::kDelayed);
  return late != nullptr ? fromSeconds(late->value) : Duration::zero();
}

std::optional<OperatorCommand> BenchFaults::hear(
    const std::optional<OperatorCommand>& command) noexcept {
  const Fault* late = faults_.active(FaultTarget::kOperatorLink, FaultMode::kDelayed);
  std::optional<OperatorCommand> heard = operator_cut_ ? std::nullopt : command;
  if (heard && late != nullptr && head_ - tail_ < kLate) {
    late_[head_++ % kLate] = {faults_.now() + fromSeconds(late->value), *heard};
    heard.reset();
  }
  if (!heard && tail_ != head_ && late_[tail_ % kLate].due <= faults_.now())
    heard = late_[tail_++ % kLate].command;
  return heard;
}

}  // namespace tautline::bench
