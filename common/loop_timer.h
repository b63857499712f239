#pragma once

/// @file
/// Pacing of a fixed-rate loop on an absolute grid. A late cycle never shifts the grid: whole
/// periods are skipped, counted and reported. The grid's arithmetic is separate from the sleeping,
/// so that it is tested without a clock.

#include <cstdint>

#include "common/time.h"

namespace tautline {

/// Where the loop is on its grid of ticks.
class TickGrid {
 public:
  /// @param period > 0. @param start the first tick.
  TickGrid(Duration period, Time start) noexcept : period_(period), next_(start) {}

  [[nodiscard]] Duration period() const noexcept { return period_; }
  [[nodiscard]] Time next() const noexcept { return next_; }

  /// Moves to the first tick that is not before `now` and after the present one; returns how many
  /// whole periods were skipped (0 when the loop is in time). Real-time safe: no allocation, no
  /// locks, no exceptions.
  std::int64_t advance(Time now) noexcept {
    next_ += period_;
    if (now <= next_) return 0;
    const std::int64_t behind = (now - next_ + period_ - Duration(1)) / period_;
    next_ += behind * period_;
    return behind;
  }

 private:
  Duration period_;
  Time next_;
};

/// Sleeps until `t` on CLOCK_MONOTONIC with an absolute time-out; returns at once if `t` has
/// passed. (libstdc++'s sleep_until sleeps relatively, which adds the time between its two steps to
/// the lateness.) A signal ends the sleep early. Real-time safe: no allocation, no locks, no
/// exceptions.
void sleepUntil(Time t) noexcept;

/// Timing of the loop over the present window (one second) and since start.
class LoopStatistics {
 public:
  struct Snapshot {
    std::int64_t cycles{0};    ///< Since start.
    std::int64_t overruns{0};  ///< Cycles whose work did not end before the next tick, since start.
    std::int64_t skipped_periods{0};  ///< Since start.
    double lateness_mean{0.0};        ///< [s] in the window.
    double lateness_max{0.0};         ///< [s] in the window.
    double work_mean{0.0};            ///< [s] in the window.
    double work_max{0.0};             ///< [s] in the window.
    double work_max_ever{0.0};        ///< [s] since start.
    std::int64_t missed_in_a_row{0};  ///< Ticks without a cycle since the last one in time: three
                                      ///< short overruns and one of three periods weigh the same.
  };

  /// One cycle: woken `lateness` after its tick, worked for `work`, then skipped whole periods (an
  /// overrun if > 0).
  void record(Duration lateness, Duration work, std::int64_t skipped_periods) noexcept;

  [[nodiscard]] Snapshot snapshot() const noexcept;

  /// Starts a new window; totals go on.
  void startWindow() noexcept;

 private:
  Snapshot totals_{};
  double lateness_sum_{0.0};
  double work_sum_{0.0};
  std::int64_t window_cycles_{0};
};

}  // namespace tautline
