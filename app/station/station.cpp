#include "app/station/station.h"

#include <memory>

namespace tautline {
namespace {

/// A condition that an operator hears of when it comes and when it goes.
struct ToldCondition {
  Condition condition;
  EventCode came;
  EventCode went;
};
constexpr std::array kToldConditions{
    ToldCondition{Condition::kReelStale, EventCode::kSensorsStale, EventCode::kSensorsBack},
    ToldCondition{Condition::kAnglesStale, EventCode::kSensorsStale, EventCode::kSensorsBack},
    ToldCondition{Condition::kVehicleStale, EventCode::kVehicleStale, EventCode::kVehicleBack},
    ToldCondition{Condition::kLinkLost, EventCode::kLinkLost, EventCode::kLinkBack},
    ToldCondition{Condition::kLocalizationLost, EventCode::kLocalizationLost,
                  EventCode::kLocalizationBack},
    ToldCondition{Condition::kVehicleFault, EventCode::kVehicleFault,
                  EventCode::kVehicleFaultCleared},
};

EventCode eventOf(MissionFailure failure) noexcept {
  switch (failure) {
    case MissionFailure::kWaypointTimeout:
      return EventCode::kWaypointTimeout;
    case MissionFailure::kNoProgress:
      return EventCode::kNoProgress;
    case MissionFailure::kBadContact:
      return EventCode::kBadContact;
    case MissionFailure::kUnreachable:
      return EventCode::kUnreachable;
    case MissionFailure::kNone:
      break;
  }
  return EventCode::kMissionCompleted;
}

}  // namespace

Station::Station(const CoreConfig& config)
    : config_(config),
      localizer_(config_.localizer),
      supervisor_(config_.supervisor),
      guidance_(config_.guidance, config_.executor, config_.control.composite.pole, config_.limits),
      controller_(makeController(config_.control)),
      dead_zone_(config_.reel_dead_zone),
      gate_(config_.gate, config_.limits),
      dialogue_(config_, missions_) {}

const StepOutput& Station::step(const StepInput& in) noexcept {
  const Duration dt = last_step_ ? in.now - *last_step_ : Duration::zero();
  if (!last_step_) localizer_.reset(config_.guidance.home_position_m, in.now);
  last_step_ = in.now;
  out_.event_count = 0;
  const Request request = dialogue_.take(in, supervisor_.mode());
  if (dialogue_.parameter()) reconfigure(in.now);

  // Sense: ages and ranges, then where the drone is.
  const ConditionSet conditions_before = out_.conditions;
  out_.anchor = guidance_.contacts().anchor();
  out_.estimate = localizer_.update(in.now, in.sensors, last_command_, out_.anchor);
  out_.conditions = assess(in, out_.estimate) | dialogue_.conditions(in.now, supervisor_.mode());
  tellChanges(conditions_before);
  tellLink(in.sensors.link.fault);

  // Decide: what the operator asks for, what the supervisor allows.
  out_.supervision = supervisor_.step(in.now, out_.conditions, request);
  dialogue_.answer(in.now, out_.supervision);
  if (out_.supervision.changed) enterMode(in.now);

  // Fly: where to, how, and the last gate.  Critical for safety: nothing may come between the gate
  // and the override.
  const MissionState mission_before = guidance_.mission().state;
  const GuidanceOutput guidance = guidance_.update({.now = in.now,
                                                    .dt = dt,
                                                    .mode = out_.supervision.mode,
                                                    .entered = out_.supervision.changed,
                                                    .estimate = out_.estimate,
                                                    .vehicle = in.sensors.vehicle.value.phase,
                                                    .sensors = &in.sensors,
                                                    .plan = missions_.active(),
                                                    .teleop = dialogue_.authority().rates(in.now)});
  const VehicleCommand wanted = control(dt, guidance);
  const VehicleCommand gated = gate_.apply(dt, wanted).command;
  out_.command = override(gated);
  out_.command.length_rate = dead_zone_.compensate(dt, out_.command.length_rate);
  last_command_ = out_.command;

  // Tell.
  out_.ack = dialogue_.ack();
  out_.operators = &dialogue_;
  out_.mission = guidance_.mission();
  out_.contact_id = guidance_.contacts().activeId();
  out_.loaded_hash = missions_.loaded() != nullptr ? missions_.loaded()->hash : 0;
  out_.mission_items = missions_.receivedWaypoints();
  if (out_.mission.state != mission_before) tellMission(out_.mission);
  return out_;
}

ConditionSet Station::assess(const StepInput& in, const Estimate& estimate) noexcept {
  const SensorFrame& f = in.sensors;
  const SensorHealth& health = localizer_.sensorHealth();
  const auto unusable = [&](SensorStream stream) { return !health[stream].ok(); };
  ConditionSet set = guidance_.conditions();
  set.set(Condition::kReelStale, unusable(SensorStream::kReel));
  set.set(Condition::kAnglesStale, unusable(SensorStream::kAngles));
  set.set(Condition::kAttitudeStale, unusable(SensorStream::kAttitude));
  set.set(Condition::kVehicleStale, unusable(SensorStream::kVehicle));
  set.set(Condition::kLinkLost, !f.link.connected);
  set.set(Condition::kLinkFault, f.link.fault != LinkFault::kNone);
  set.set(Condition::kLocalizationLost, !estimate.usable());
  set.set(Condition::kVehicleFault,
          f.vehicle.sequence > 0 && f.vehicle.value.phase == VehiclePhase::kFault);
  set.set(Condition::kVehicleFlying,
          f.vehicle.sequence > 0 && (f.vehicle.value.phase == VehiclePhase::kFlying ||
                                     f.vehicle.value.phase == VehiclePhase::kLanding));
  const MissionPlan* waiting = missions_.loaded();
  set.set(Condition::kMissionLoaded, waiting != nullptr);
  set.set(Condition::kTetherElsewhere,
          waiting != nullptr && !guidance_.startsWithPresentTether(*waiting));
  set.set(Condition::kOverruns, in.missed_in_a_row >= config_.overruns_in_a_row);
  return set;
}

/// New numbers for every part that is not made at start-up; on the ground, where nothing is under
/// way. Guidance is made anew in its place, for its parts refer to each other.
void Station::reconfigure(Time now) noexcept {
  localizer_ = Localizer(config_.localizer);
  localizer_.reset(config_.guidance.home_position_m, now);
  supervisor_ = Supervisor(config_.supervisor);
  std::destroy_at(&guidance_);
  std::construct_at(&guidance_, config_.guidance, config_.executor, config_.control.composite.pole,
                    config_.limits);
  dead_zone_ = ReelDeadZone(config_.reel_dead_zone);
  gate_ = CommandGate(config_.gate, config_.limits);
}

void Station::enterMode(Time now) noexcept {
  const Mode mode = out_.supervision.mode;
  tell({EventCode::kModeChanged, mode, out_.supervision.reasons});
  if (mode == Mode::kAuto) missions_.activate();
  if (mode == Mode::kStandby) {
    localizer_.reset(config_.guidance.home_position_m, now);
    controller_->reset();
    dead_zone_.reset();
  }
}

/// Rates for the route, by the configured law; standing still where there is none or the law cannot
/// act.
VehicleCommand Station::control(Duration dt, const GuidanceOutput& guidance) noexcept {
  VehicleCommand command;
  command.engaged = guidance.engaged;
  command.action = guidance.action;
  command.reel_controller = guidance.reel_controller;
  if (!guidance.route.active) return command;
  const RateCommand rates = controller_->update(dt, guidance.route.control);
  if (!rates.ok) return command;
  command.length_rate = rates.length_rate;
  command.elevation_rate = rates.elevation_rate;
  command.azimuth_rate = rates.azimuth_rate;
  command.yaw_rate = guidance.route.yaw_rate;
  command.gimbal_pitch_rate = guidance.route.gimbal_pitch_rate;
  return command;
}

/// The supervisor's last word: no rates without fresh tether sensors, link and localization; none
/// on the ground.
VehicleCommand Station::override(const VehicleCommand& gated) noexcept {
  constexpr ConditionSet kStandStill{Condition::kReelStale, Condition::kAnglesStale,
                                     Condition::kLinkLost, Condition::kVehicleStale,
                                     Condition::kLocalizationLost};
  const Mode mode = out_.supervision.mode;
  if (isIn(mode, kFlyingModes) && !out_.conditions.any(kStandStill)) return gated;
  gate_.reset();
  VehicleCommand still;
  still.engaged = gated.engaged;
  still.action = gated.action;
  still.reel_controller = gated.reel_controller;
  return still;
}

void Station::tell(StationEvent event) noexcept {
  if (out_.event_count < static_cast<int>(out_.events.size()))
    out_.events[static_cast<std::size_t>(out_.event_count++)] = event;
}

void Station::tellChanges(ConditionSet before) noexcept {
  if (supervisor_.mode() == Mode::kStandby) return;  // on the ground `tautline status` says it
  for (const ToldCondition& t : kToldConditions) {
    const bool is = out_.conditions.has(t.condition);
    if (is != before.has(t.condition)) tell({is ? t.came : t.went, {}, {}});
  }
  if (out_.conditions.has(Condition::kOverruns) && !before.has(Condition::kOverruns))
    tell({EventCode::kLoopOverruns, {}, {}});
}

/// On the ground too: it is there that a wrong device or a wrong setting shows.
void Station::tellLink(LinkFault fault) noexcept {
  if (fault == link_fault_) return;
  link_fault_ = fault;
  tell({eventOf(fault), {}, {}});
}

void Station::tellMission(const ExecutorStatus& mission) noexcept {
  if (mission.state == MissionState::kCompleted || mission.state == MissionState::kFailed)
    tell({eventOf(mission.failure), {}, {}});
}

}  // namespace tautline
