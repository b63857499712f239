#pragma once

/// @file
/// The fixed-rate loop around the core: wait, read, step, write, tell (docs/loop.md).

#include <csignal>

#include "app/station/black_box.h"
#include "app/station/lcm_link.h"
#include "app/station/service_notifier.h"
#include "app/station/station.h"
#include "app/station/station_device.h"
#include "app/station/telemetry.h"
#include "common/loop_timer.h"

namespace tautline {

struct LoopParts {
  Device& device;
  LcmLink& lcm;
  Station& station;
  Telemetry& telemetry;
  BlackBox* black_box;             ///< May be null.
  ServiceNotifier* service{};      ///< May be null.
  HostFacts host{};                ///< What is known at start; the loop adds what changes.
  const StationDevice* plugged{};  ///< Behind `device`; null: whether it is real is not known.
};

/// Runs until `stop` is set, then sends the device's last words. Real-time safe after the first
/// cycle: no allocation, no locks, no exceptions of ours; LCM's publish takes its own short lock.
LoopStatistics::Snapshot realTimeLoop(const LoopParts& parts, Duration period,
                                      const volatile std::sig_atomic_t& stop);

}  // namespace tautline
