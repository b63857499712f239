#pragma once

/// @file
/// What is the case becomes what counts: a condition counts when it has lasted for its guard time,
/// and no longer when it has been gone for its recovery time (kConditionInfos). One garbled sample
/// ends no flight, and a fault that flickers is one fault.

#include <array>

#include "common/time.h"
#include "supervision/condition.h"

namespace tautline {

class ConditionFilter {
 public:
  /// One cycle; `raw` is what is the case now. `now` must not go back. Real-time safe: no
  /// allocation, no locks, no exceptions.
  [[nodiscard]] ConditionSet update(Time now, ConditionSet raw) noexcept;

 private:
  ConditionSet raw_;                             ///< Of the last cycle.
  ConditionSet counting_;                        ///< What counts.
  std::array<Time, kConditionCount> changed_{};  ///< When raw last came or went.
};

}  // namespace tautline
