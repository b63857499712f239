#pragma once

/// @file
/// Flies one case and says what came of it.

#include <string>

#include "app/bench/flight_case.h"

namespace tautline::bench {

struct CaseResult {
  std::string name;
  std::uint64_t seed{0};
  std::string failure;  ///< What was expected and what happened; empty: nothing went wrong.
  std::string skipped;  ///< Why it was not flown; empty: it was.
  Mode end{Mode::kStandby};
  sim::CrashReason crash{sim::CrashReason::kNone};
  bool faulted{false};   ///< The first fault has begun: the flight got that far.
  double flight_s{0.0};  ///< The rig's time.
  double wall_s{0.0};
  int flights{1};            ///< Until there was one that counts.
  double height_max_m{0.0};  ///< Over the floor.

  [[nodiscard]] bool passed() const noexcept { return failure.empty() && skipped.empty(); }
};

/// Flies until the station has been back in STANDBY or in ESTOP for a while, the vehicle has
/// crashed, or the time is over; ends at the first thing that is wrong. `sink` as in Lockstep.
/// Throws InputError for a fault that this device cannot have.
[[nodiscard]] CaseResult runCase(const FlightCase& flight, TelemetrySink* sink);

/// The same on a rig that has just been made for this flight.
[[nodiscard]] CaseResult runCase(const FlightCase& flight, Rig& rig);

/// One that has only its name yet.
[[nodiscard]] CaseResult resultOf(const FlightCase& flight);

}  // namespace tautline::bench
