#pragma once

/// @file
/// Station and simulated machine in flight, however the bench puts them together: in one process on
/// a virtual clock (lockstep.h), or as the real programs on the wall clock (hil_rig.h). What a case
/// sees of a flight, and what it does in it.

#include <optional>

#include <tautline/mission_chunk_t.hpp>

#include "app/station/station.h"
#include "app/station/station_config.h"
#include "common/time.h"
#include "common/vehicle.h"
#include "sim_hil/fault.h"
#include "sim_hil/truth.h"
#include "supervision/operator_command.h"

namespace tautline::bench {

class Rig {
 public:
  Rig() = default;
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  virtual ~Rig() = default;

  /// One cycle of the station, with an operator's command or a piece of a mission if there is one.
  virtual const StepOutput& step(const std::optional<OperatorCommand>& command,
                                 const tautline::mission_chunk_t* chunk) = 0;

  /// Schedules a fault of machine or bench; a time that is past means now. Throws InputError if
  /// this rig cannot have it, or if too many are scheduled already.
  virtual void inject(const sim::Fault& fault) = 0;

  /// Sticks of the operator from the next cycle on; none: hands off.
  virtual void holdSticks(const std::optional<Sticks>& sticks) = 0;

  [[nodiscard]] virtual Time now() const noexcept = 0;  ///< From Time{}, where the run starts.
  [[nodiscard]] virtual const StationConfig& station() const noexcept = 0;  ///< Effective.
  [[nodiscard]] virtual const StepOutput& output() const noexcept = 0;      ///< Of the last cycle.
  [[nodiscard]] virtual const sim::Truth& truth() const noexcept = 0;
  [[nodiscard]] virtual const SensorFrame& sensors() const noexcept = 0;
  [[nodiscard]] virtual double floor() const noexcept = 0;  ///< In W [m].

  /// How much later than it happens something may be done or seen here.
  [[nodiscard]] virtual Duration allowance() const noexcept = 0;
};

}  // namespace tautline::bench
