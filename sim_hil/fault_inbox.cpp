#include "sim_hil/fault_inbox.h"

#include <cstdio>

#include "common/error.h"
#include "lcmtypes/channels.h"
#include "lcmtypes/lcm_access.h"
#include "sim_hil/fault.h"

namespace tautline::sim {

FaultInbox::FaultInbox(const std::string& lcm_url, SimDevice device)
    : lcm_(reachable(lcm_url)), device_(device) {
  if (!lcm_.good()) throw cannotJoin(lcm_url);
  // Room for all that can be scheduled, each told a few times.
  constexpr int kQueue = 4 * static_cast<int>(kMaxFaults);
  lcm_.subscribe(channel::kSimFault, &FaultInbox::onFault, this)->setQueueCapacity(kQueue);
}

void FaultInbox::poll(Simulator& simulator) {
  simulator_ = &simulator;
  while (lcm_.handleTimeout(0) > 0) {
  }
}

void FaultInbox::onFault(const lcm::ReceiveBuffer*, const std::string&,
                         const tautline::sim_fault_t* message) {
  if (message->utime <= last_utime_) return;
  last_utime_ = message->utime;
  try {
    Fault fault = parseFault(message->fault);
    checkFault(fault, device_, false);
    fault.at = simulator_->now() + (fault.at - Time{});
    if (simulator_->inject(fault)) return;
    throw tooManyFaults(fault);
  } catch (const InputError& e) {
    std::fprintf(stderr, "tautline-sim: SIM_FAULT refused: %s\n", e.what());
  }
}

}  // namespace tautline::sim
