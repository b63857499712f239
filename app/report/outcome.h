#pragma once

/// @file
/// Which messages of a log are about the mission, and how it ended. Not real-time safe.

#include <vector>

#include "app/report/analysis.h"
#include "app/report/flight_log.h"

namespace tautline::report {

[[nodiscard]] bool isAirborne(VehiclePhase phase);

/// What the executor said about the mission that was flown last, while it flew it.
[[nodiscard]] std::vector<MissionSample> ofLastMission(const FlightLog& log);

/// `mission` from ofLastMission(), `modes` as they followed each other.
[[nodiscard]] Outcome findOutcome(const FlightLog& log, const std::vector<MissionSample>& mission,
                                  const std::vector<ModeSpan>& modes);

}  // namespace tautline::report
