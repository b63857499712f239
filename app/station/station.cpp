#include "app/station/station.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace tautline {
namespace {

/// A landing stops its reel so much before the tether reaches the floor [m].
constexpr double kShortOfFloor = 0.05;

/// What an operator hears of when it comes and when it goes: all but the facts of a flight.
constexpr ConditionSet kTold =
    ConditionSet::fromBits(~std::uint64_t{0})
        .without(conditionsOf(ConditionKind::kFact) | ConditionSet{Condition::kVehicleFlying});

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
      monitor_(config_),
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
  out_.conditions = assess(in);
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
                                                    .conditions = out_.conditions,
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

ConditionSet Station::assess(const StepInput& in) noexcept {
  ConditionSet facts = guidance_.conditions() | dialogue_.conditions(in.now, supervisor_.mode());
  const MissionPlan* waiting = missions_.loaded();
  facts.set(Condition::kMissionLoaded, waiting != nullptr);
  facts.set(Condition::kTetherElsewhere,
            waiting != nullptr && !guidance_.startsWithPresentTether(*waiting));
  const ConditionSet counting = monitor_.update({.now = in.now,
                                                 .sensors = &in.sensors,
                                                 .health = &localizer_.sensorHealth(),
                                                 .estimate = &out_.estimate,
                                                 .anchor = &out_.anchor,
                                                 .last_command = &last_command_,
                                                 .host = &in.host,
                                                 .missed_in_a_row = in.missed_in_a_row,
                                                 .mode = supervisor_.mode(),
                                                 .facts = facts});
  out_.findings = monitor_.findings();
  return counting;
}

/// New numbers for every part that is not made at start-up; on the ground, where nothing is under
/// way. Parts that refer to others are made anew in their place.
void Station::reconfigure(Time now) noexcept {
  localizer_ = Localizer(config_.localizer);
  localizer_.reset(config_.guidance.home_position_m, now);
  std::destroy_at(&monitor_);
  std::construct_at(&monitor_, config_);
  supervisor_ = Supervisor(config_.supervisor);
  std::destroy_at(&guidance_);
  std::construct_at(&guidance_, config_.guidance, config_.executor, config_.control.composite.pole,
                    config_.limits);
  dead_zone_ = ReelDeadZone(config_.reel_dead_zone);
  gate_ = CommandGate(config_.gate, config_.limits);
}

void Station::enterMode(Time now) noexcept {
  const Mode mode = out_.supervision.mode;
  tell({.code = EventCode::kModeChanged, .mode = mode, .reasons = out_.supervision.reasons});
  if (mode == Mode::kAuto) missions_.activate();
  if (mode == Mode::kStandby) {
    localizer_.reset(config_.guidance.home_position_m, now);
    controller_->reset();
    dead_zone_.reset();
  }
}

/// From the anchor to the floor below the drone, or to home if that is nearer [m]. The floor is
/// taken to be as high as home.
double Station::lengthToFloor() const noexcept {
  const Eigen::Vector3d p_AH = config_.guidance.home_position_m - out_.anchor.p_WA;
  const Eigen::Vector3d p_AD = out_.estimate.p_WD - out_.anchor.p_WA;
  return std::min(std::hypot(p_AD.x(), p_AH.y(), p_AD.z()), p_AH.norm());
}

/// Rates for the route, by the configured law; where there is none or the law cannot act, those of
/// guidance.
VehicleCommand Station::control(Duration dt, const GuidanceOutput& guidance) noexcept {
  VehicleCommand command = guidance.command;
  if (!guidance.route.active) return command;
  const RateCommand rates = controller_->update(dt, guidance.route.control);
  if (!rates.ok) return command;
  // Where a landing may meet the floor at any moment no more is paid out than it takes to come down
  // to it: on the floor the tether would go slack and swing.
  const bool stops_reel = out_.supervision.mode == Mode::kLand &&
                          guidance.route.control.p_WE.y() < config_.guidance.home_position_m.y() &&
                          config_.guidance.isNearFloor(out_.estimate.p_WD) &&
                          !(out_.estimate.L_free < lengthToFloor() - kShortOfFloor);
  command.length_rate = stops_reel ? std::min(rates.length_rate, 0.0) : rates.length_rate;
  command.elevation_rate = rates.elevation_rate;
  command.azimuth_rate = rates.azimuth_rate;
  command.yaw_rate = guidance.route.yaw_rate;
  command.gimbal_pitch_rate = guidance.route.gimbal_pitch_rate;
  return command;
}

/// The supervisor's last word: no rates without fresh tether sensors, link and localization, but to
/// come down without them; none on the ground; no way outwards at the end of the tether, or where
/// it pulls too hard or hangs.
VehicleCommand Station::override(const VehicleCommand& gated) noexcept {
  constexpr ConditionSet kNoPayOut{Condition::kOverTension, Condition::kReelLimit,
                                   Condition::kTetherSlack};
  const Mode mode = out_.supervision.mode;
  // A descent does not ask the tether where it is.
  const ConditionSet stand_still = mode == Mode::kDescend ? kUnheard : kStandStill;
  if (isIn(mode, kFlyingModes) && !out_.conditions.any(stand_still)) {
    VehicleCommand allowed = gated;
    if (out_.conditions.any(kNoPayOut)) allowed.length_rate = std::min(allowed.length_rate, 0.0);
    return allowed;
  }
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
  for (const ConditionInfo& info : kConditionInfos) {
    const Condition c = info.condition;
    const bool is = out_.conditions.has(c);
    if (is == before.has(c) || !kTold.has(c)) continue;
    tell({.code = is ? EventCode::kConditionCame : EventCode::kConditionWent,
          .condition = c,
          .value = out_.findings.valueOf(c),
          .limit = out_.findings.limitOf(c)});
  }
}

/// On the ground too: it is there that a wrong device or a wrong setting shows.
void Station::tellLink(LinkFault fault) noexcept {
  if (fault == link_fault_) return;
  link_fault_ = fault;
  tell({.code = eventOf(fault)});
}

void Station::tellMission(const ExecutorStatus& mission) noexcept {
  if (mission.state == MissionState::kCompleted || mission.state == MissionState::kFailed)
    tell({.code = eventOf(mission.failure)});
}

}  // namespace tautline
