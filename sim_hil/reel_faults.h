#pragma once

/// @file
/// Faults of the reel's drive: how the drum turns instead of how it is commanded.

#include "sim_hil/fault_schedule.h"
#include "sim_hil/reel.h"

namespace tautline::sim {

class ReelFaults {
 public:
  /// What the faults of now make of a drum that is asked for `wanted` [m/s, pay-out positive].
  /// Real-time safe: no allocation, no locks, no exceptions.
  [[nodiscard]] ReelDisturbance step(double wanted, FaultSchedule& faults) noexcept;

 private:
  static constexpr std::size_t kHistory = 4096;  // 2 s of steps of 0.5 ms

  History<double, kHistory> history_;
  LooseContact contact_;
  double held_{0.0};    // last rate that was asked for before it was stuck [m/s]
  double random_{0.0};  // [m/s]
  Time next_random_{};
};

}  // namespace tautline::sim
