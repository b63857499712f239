#pragma once

/// @file
/// What the detectors say in a cycle: which conditions are the case now, before guard and recovery
/// times, and for each the measured value and the limit that it was held against.

#include <array>

#include "supervision/condition.h"

namespace tautline {

/// Real-time safe: no allocation, no locks, no exceptions.
struct Findings {
  ConditionSet raised;
  std::array<double, kConditionCount> value{};  ///< In the condition's unit (kConditionInfos).
  std::array<double, kConditionCount> limit{};

  /// Several detectors may report one condition: it is the case if any of them says so, and the
  /// figures are those of the last one that does.
  void report(Condition c, bool is, double measured = 0.0, double allowed = 0.0) noexcept {
    const auto i = static_cast<std::size_t>(c);
    if (is || !raised.has(c)) {
      value[i] = measured;
      limit[i] = allowed;
    }
    if (is) raised.set(c);
  }
  /// The same for what must not be above its limit.
  void reportAbove(Condition c, double measured, double allowed) noexcept {
    report(c, measured > allowed, measured, allowed);
  }
  /// The same for what must not be below its limit.
  void reportBelow(Condition c, double measured, double allowed) noexcept {
    report(c, measured < allowed, measured, allowed);
  }
  [[nodiscard]] double valueOf(Condition c) const noexcept {
    return value[static_cast<std::size_t>(c)];
  }
  [[nodiscard]] double limitOf(Condition c) const noexcept {
    return limit[static_cast<std::size_t>(c)];
  }
};

}  // namespace tautline
