#pragma once

/// @file
/// The one place that reads the machine's clocks. Everything else gets its time as an argument.

#include <sys/timex.h>

#include "common/time.h"

namespace tautline {

/// CLOCK_MONOTONIC now. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] inline Time monotonicNow() noexcept {
  return std::chrono::time_point_cast<Duration>(std::chrono::steady_clock::now());
}

/// What to add to a monotonic time to get Unix time, as of this call. Taken once at start, so that
/// a wall clock that is set during a flight never makes `utime` jump.
[[nodiscard]] inline Duration unixOffset() noexcept {
  const auto unix_now =
      std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch());
  return unix_now - monotonicNow().time_since_epoch();
}

/// Whether the kernel holds the wall clock for synchronized (NTP, PTP). Real-time safe: no
/// allocation, no locks, no exceptions.
[[nodiscard]] inline bool clockSynchronized() noexcept {
  timex query{};
  return adjtimex(&query) != TIME_ERROR;
}

}  // namespace tautline
