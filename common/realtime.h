#pragma once

/// @file
/// Real-time start-up of a process: memory, processor, priority. Called once before the loop; every
/// step says what it did or why it could not, and reads back what it set. Not real-time safe:
/// start-up only.

#include <string>
#include <vector>

namespace tautline {

/// One step of the start-up.
struct RealTimeStep {
  bool ok{false};
  std::string name;    ///< e.g. "SCHED_FIFO priority 50"
  std::string reason;  ///< Why not, and the command that mends it; empty if ok.
};

/// mlockall(present and future) and the heap kept from giving memory back to the kernel.
[[nodiscard]] RealTimeStep lockMemory();

/// Touches the stack that the loop will use, so that it never faults a page in.
[[nodiscard]] RealTimeStep prefaultStack();

/// Pins the calling thread to one processor.
[[nodiscard]] RealTimeStep setAffinity(int cpu);

/// SCHED_FIFO with a middle priority (the maximum can starve kernel threads that the drivers need),
/// read back.
[[nodiscard]] RealTimeStep setFifoPriority(int priority);

struct RealTimeConfig {
  int priority{50};  ///< SCHED_FIFO priority, 1–98; 0 leaves the scheduler alone.
  int cpu{-1};       ///< Processor to pin the loop to; -1 leaves it free.
};

/// All steps in order.
[[nodiscard]] std::vector<RealTimeStep> startRealTime(const RealTimeConfig& config);

}  // namespace tautline
