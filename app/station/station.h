#pragma once

/// @file
/// The station's core: one cycle from what the sensors say to what the vehicle is told
/// (docs/loop.md). Pure: no clock, no file, no socket, no log. Around it app/station puts drivers
/// and LCM, app/bench puts the plant; the same input gives the same output, always.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include <tautline/mission_chunk_t.hpp>

#include "app/station/condition_monitor.h"
#include "app/station/events.h"
#include "app/station/guidance.h"
#include "app/station/mission_store.h"
#include "app/station/operator_dialogue.h"
#include "app/station/station_config.h"
#include "common/estimate.h"
#include "common/vehicle.h"
#include "control/command_gate.h"
#include "control/controller.h"
#include "control/reel_dead_zone.h"
#include "estimation/localizer.h"
#include "supervision/supervisor.h"

namespace tautline {

/// All that a cycle sees.
struct StepInput {
  Time now{};
  SensorFrame sensors;
  std::optional<OperatorCommand> command;
  std::optional<Heartbeat> heartbeat;  ///< Of the operator who holds the lease.
  std::optional<Sticks> sticks;        ///< The same operator's.
  std::optional<TurnedAway> turned_away;
  const tautline::mission_chunk_t* chunk{
      nullptr};                     ///< A piece of a mission, or none; used during the call only.
  std::int32_t missed_in_a_row{0};  ///< Ticks that the loop has missed, as of the last cycle.
  HostFacts host;
};

/// All that a cycle says.
struct StepOutput {
  VehicleCommand command;
  Estimate estimate;
  Anchor anchor;
  int contact_id{kReelContact};
  ConditionSet conditions;  ///< What counts, after guard and recovery times.
  Findings findings;        ///< What is the case in this cycle, with measured values and limits.
  SupervisorOutput supervision;
  ExecutorStatus mission;
  std::uint64_t loaded_hash{0};  ///< Of the mission that waits to be flown, 0 = none.
  int mission_items{0};          ///< Its waypoints received so far.
  std::optional<CommandAck> ack;
  const OperatorDialogue* operators{nullptr};  ///< The station's own; never null after a step.
  std::array<StationEvent, 16> events{};
  int event_count{0};
};

class Station {
 public:
  /// Not real-time safe: start-up only.
  explicit Station(const CoreConfig& config);

  /// One cycle. `in.now` must not go back. Real-time safe: no allocation, no locks, no exceptions.
  [[nodiscard]] const StepOutput& step(const StepInput& in) noexcept;

  /// Who may command.
  [[nodiscard]] const Lease& lease() const noexcept { return dialogue_.authority().lease(); }

 private:
  [[nodiscard]] ConditionSet assess(const StepInput& in) noexcept;
  void reconfigure(Time now) noexcept;
  void enterMode(Time now) noexcept;
  [[nodiscard]] double lengthToFloor() const noexcept;
  [[nodiscard]] VehicleCommand control(Duration dt, const GuidanceOutput& guidance) noexcept;
  [[nodiscard]] VehicleCommand override(const VehicleCommand& gated) noexcept;
  void tell(StationEvent event) noexcept;
  void tellChanges(ConditionSet before) noexcept;
  void tellLink(LinkFault fault) noexcept;
  void tellMission(const ExecutorStatus& mission) noexcept;

  CoreConfig config_;
  Localizer localizer_;
  ConditionMonitor monitor_;
  Supervisor supervisor_;
  Guidance guidance_;
  std::unique_ptr<Controller> controller_;
  ReelDeadZone dead_zone_;
  CommandGate gate_;
  MissionStore missions_;
  OperatorDialogue dialogue_;

  std::optional<Time> last_step_;
  VehicleCommand last_command_;
  StepOutput out_;
  LinkFault link_fault_{LinkFault::kNone};  ///< Last told.
};

}  // namespace tautline
