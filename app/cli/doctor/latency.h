#pragma once

/// @file
/// Wake-up latency of this machine as the station's loop would meet it, and its summary. Not
/// real-time safe.

#include <string>
#include <vector>

#include "common/time.h"

namespace tautline::cli {

/// Runs an empty loop of `period` for `length` with the station's pacing (TickGrid, sleepUntil) and
/// start-up (memory locked, SCHED_FIFO 50 where it is allowed); one lateness for each cycle, in
/// order. Takes a thread of its own, so that the caller's priority stays as it is.
[[nodiscard]] std::vector<Duration> measureLateness(Duration period, Duration length);

/// Smallest of `sorted` that is not exceeded by the share `q`, 0 < q <= 1 (nearest rank).
/// Pre-condition: sorted, not empty.
[[nodiscard]] Duration quantile(const std::vector<Duration>& sorted, double q);

/// Lines "upper bound  count  bar" with bounds of 1, 2, 5, 10, … us; empty classes at both ends are
/// left out.
[[nodiscard]] std::string latencyHistogram(const std::vector<Duration>& lateness);

}  // namespace tautline::cli
