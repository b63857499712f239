#pragma once

/// @file
/// When something that is done every so often is due again, in a loop whose period need not divide
/// the interval.

#include <optional>

#include "common/time.h"

namespace tautline {

/// Keeps to a grid, so that the mean rate is right whatever the loop's period is; starts a new grid
/// when it was done early or more than one interval late. Real-time safe: no allocation, no locks,
/// no exceptions.
class Pace {
 public:
  /// The loop's jitter must not make it miss its turn by one cycle.
  static constexpr Duration kTolerance = std::chrono::milliseconds(1);

  [[nodiscard]] bool due(Time now) const noexcept { return !next_ || now >= *next_ - kTolerance; }

  /// It was done at `now`, because it was due or because it could not wait.
  void done(Time now, Duration interval) noexcept {
    const bool on_grid = next_ && due(now) && now < *next_ + interval;
    next_ = (on_grid ? *next_ : now) + interval;
  }

  /// Due at once.
  void reset() noexcept { next_.reset(); }

 private:
  std::optional<Time> next_;
};

}  // namespace tautline
