#include "supervision/fault_log.h"

#include <algorithm>

namespace tautline {

void FaultLog::update(Time now, const SupervisorOutput& step) noexcept {
  constexpr ModeMask kFailsafeModes =
      maskOf({Mode::kFailsafe, Mode::kReturn, Mode::kLand, Mode::kDescend, Mode::kEstop});
  if (!step.changed || !isIn(step.mode, kFailsafeModes)) return;
  for (const ConditionInfo& info : kConditionInfos) {
    if (info.kind == ConditionKind::kFact || !step.reasons.has(info.condition)) continue;
    faults_[next_] = {now, info.condition, step.mode};
    next_ = (next_ + 1) % kCapacity;
    count_ = std::min(count_ + 1, kCapacity);
    latched_ = true;
  }
}

}  // namespace tautline
