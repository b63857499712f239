#pragma once

/// @file
/// Runs a Simulator on the wall clock and connects it with its link: tautline-sim's loop.

#include <csignal>
#include <cstdint>

#include "common/time.h"
#include "sim_hil/byte_link.h"
#include "sim_hil/fault_inbox.h"
#include "sim_hil/simulator.h"
#include "sim_hil/truth_publisher.h"

namespace tautline::sim {

struct ServerSummary {
  Duration served{};         ///< Simulated time.
  Duration time_lost{};      ///< Wall time that the simulation could not follow and left out.
  std::uint32_t clients{0};  ///< Times that a client came.
};

/// Serves until `stop` is set or `duration` has been simulated (zero: no end). Wakes up on an
/// absolute grid; if the machine cannot follow, it catches up by at most 100 ms and leaves out the
/// rest.
/// @param faults where faults come from meanwhile; null: from nowhere.
[[nodiscard]] ServerSummary serve(Simulator& simulator, ByteLink& link, TruthPublisher& publisher,
                                  FaultInbox* faults, Duration duration,
                                  const volatile std::sig_atomic_t& stop);

}  // namespace tautline::sim
