#pragma once

/// @file
/// When a cumulated log likelihood ratio is believed.

#include <algorithm>
#include <cmath>

namespace tautline {

/// A ratio that says e^h has odds of e^-h in each of its independent samples, which come every
/// `correlation_time_s`. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] inline double evidenceThreshold(int hypotheses, double correlation_time_s,
                                              double false_alarms_per_hour) noexcept {
  return std::max(1.0,
                  std::log(3600.0 * hypotheses / (correlation_time_s * false_alarms_per_hour)));
}

}  // namespace tautline
