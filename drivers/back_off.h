#pragma once

/// @file
/// When to try again what has failed: soon, then less and less often, for ever.

#include <algorithm>
#include <optional>

#include "common/time.h"

namespace tautline {

/// Real-time safe: no allocation, no locks, no exceptions.
class BackOff {
 public:
  static constexpr Duration kFirst = std::chrono::milliseconds(100);
  static constexpr Duration kSlowest = std::chrono::seconds(2);

  /// To be asked again and again; true when it is time for an attempt, first kFirst after the first
  /// question.
  [[nodiscard]] bool due(Time now) noexcept {
    if (!next_) {
      next_ = now + wait_;
      return false;
    }
    if (now < *next_) return false;
    wait_ = std::min(2 * wait_, kSlowest);
    next_ = now + wait_;
    return true;
  }

  /// It has worked: starts anew.
  void reset() noexcept {
    next_.reset();
    wait_ = kFirst;
  }

 private:
  std::optional<Time> next_;
  Duration wait_{kFirst};
};

}  // namespace tautline
