#pragma once

/// @file
/// Faults that somebody else tells while the machine runs: SIM_FAULT over LCM.

#include <cstdint>
#include <string>

#include <lcm/lcm-cpp.hpp>
#include <tautline/sim_fault_t.hpp>

#include "sim_hil/simulator.h"

namespace tautline::sim {

class FaultInbox {
 public:
  /// Joins LCM. Throws InputError: kTimeout without a multicast route, with the command that mends
  /// it; kUsage for a URL that LCM does not know. Not real-time safe: start-up only.
  FaultInbox(const std::string& lcm_url, SimDevice device);

  /// Schedules what has come since the last call; a fault that this machine cannot have is refused
  /// with one line on stderr. Never waits. Not real-time safe.
  void poll(Simulator& simulator);

 private:
  void onFault(const lcm::ReceiveBuffer*, const std::string&, const tautline::sim_fault_t* message);

  lcm::LCM lcm_;
  SimDevice device_;
  Simulator* simulator_{nullptr};  ///< During poll().
  std::int64_t last_utime_{0};     ///< Of the last one taken or refused; copies have the same.
};

}  // namespace tautline::sim
