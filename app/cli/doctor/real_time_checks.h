#pragma once

/// @file
/// Checks of what the machine gives a real-time loop: rights, processors, clocks, wake-up latency.
/// Each reads only below Machine::root. Not real-time safe.

#include "app/cli/doctor/check.h"

namespace tautline::cli {

/// The right to SCHED_FIFO, and real-time time that is not taken away again.
[[nodiscard]] Finding checkPriority(const Machine& machine);

/// The right to lock memory.
[[nodiscard]] Finding checkMemlock(const Machine& machine);

/// PREEMPT_RT, or advice to have it.
[[nodiscard]] Finding checkKernel(const Machine& machine);

/// No processor changes its frequency under the loop.
[[nodiscard]] Finding checkGovernor(const Machine& machine);

/// A clock that is read without a system call to a slow device.
[[nodiscard]] Finding checkClockSource(const Machine& machine);

/// The wall clock is right, so that logs of different machines fit together.
[[nodiscard]] Finding checkClockSynchronized(const Machine& machine);

/// A processor for the loop alone.
[[nodiscard]] Finding checkIsolatedCpus(const Machine& machine);

/// Wake-up lateness at the loop's own pacing: 99 % within a tenth of the period, at most
/// one cycle in a thousand misses its tick.
[[nodiscard]] Finding checkLatency(const Machine& machine);

}  // namespace tautline::cli
