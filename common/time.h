#pragma once

/// @file
/// Time inside Tautline: monotonic, nanoseconds, strongly typed. Bare numbers never stand for a
/// time; seconds as `double` exist only inside formulas, through toSeconds().

#include <chrono>
#include <cstdint>

namespace tautline {

using Duration = std::chrono::nanoseconds;

/// A point on CLOCK_MONOTONIC (or on the virtual clock of the lock-step bench).
using Time = std::chrono::time_point<std::chrono::steady_clock, Duration>;

/// [s]. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] constexpr double toSeconds(Duration d) noexcept {
  return std::chrono::duration<double>(d).count();
}

/// Nearest nanosecond to `seconds`, |seconds| < 2^53 ns. Real-time safe: no allocation, no locks,
/// no exceptions.
[[nodiscard]] constexpr Duration fromSeconds(double seconds) noexcept {
  return Duration(static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0.0 ? -0.5 : 0.5)));
}

/// Microseconds since the clock's origin, the unit of every LCM message's `utime`.
[[nodiscard]] constexpr std::int64_t toMicroseconds(Time t) noexcept {
  return std::chrono::duration_cast<std::chrono::microseconds>(t.time_since_epoch()).count();
}

}  // namespace tautline
