#include "supervision/condition_filter.h"

namespace tautline {

ConditionSet ConditionFilter::update(Time now, ConditionSet raw) noexcept {
  for (std::size_t i = 0; i < kConditionCount; ++i) {
    const ConditionInfo& info = kConditionInfos[i];
    const bool is = raw.has(info.condition);
    if (is != raw_.has(info.condition)) changed_[i] = now;
    if (is == counting_.has(info.condition)) continue;
    const double patience = is ? info.guard_s : info.recovery_s;
    if (now - changed_[i] >= fromSeconds(patience)) counting_.set(info.condition, is);
  }
  raw_ = raw;
  return counting_;
}

}  // namespace tautline
