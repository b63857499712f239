#include "supervision/supervisor.h"

namespace tautline {
namespace {

using C = Condition;
using M = Mode;
using R = Request;

/// The tether's sensors cannot be flown by.
constexpr ConditionSet kSensorsBad{C::kReelStale,   C::kReelStuck,   C::kReelJump,
                                   C::kAnglesStale, C::kAnglesStuck, C::kAnglesJump};
constexpr ConditionSet kBlind = kSensorsBad | ConditionSet{C::kLocalizationLost};
/// No time for anything but the way down.
constexpr ConditionSet kMustLand{C::kLinkLost, C::kVehicleStale, C::kVehicleFault,
                                 C::kBatteryCritical, C::kTetherPowerLost};
/// Out of a fence; the way back is the way out of it.
constexpr ConditionSet kOutside{C::kFenceLength, C::kFenceAltitude, C::kFenceElevation,
                                C::kFenceKeepOut, C::kFenceClearance};
/// Something holds the tether, or does not where it should: moving on makes it worse.
constexpr ConditionSet kCaught{C::kTetherSnagged, C::kUnplannedContact, C::kContactLost,
                               C::kContactNotFormed, C::kOverTension};
/// The flight is not under control.
constexpr ConditionSet kUnsteady{C::kTetherSlack, C::kOscillation, C::kOverruns, C::kClockJump};
/// The way home is called for, and can wait until it is safe.
constexpr ConditionSet kComeBack = kOutside | ConditionSet{C::kOperatorLost, C::kMissionFailed};
constexpr ConditionSet kNotReady = conditionsOf(ConditionKind::kForbidsArming);

constexpr ModeMask kUnderWay = maskOf({M::kTakeoff, M::kHold, M::kTeleop, M::kAuto});
constexpr ModeMask kGoingBack = maskOf({M::kBackUp, M::kReturn});
constexpr ModeMask flyingBut(std::initializer_list<Mode> modes) noexcept {
  return static_cast<ModeMask>(kFlyingModes & ~maskOf(modes));
}

// clang-format off
constexpr std::array kTransitions{
    // By themselves, most severe first.
    Transition{kFlyingModes, R::kNone, {C::kTouchdown}, {}, {C::kVehicleFlying}, M::kStandby},
    Transition{kFlyingModes, R::kNone, {C::kVehicleDanger}, {}, {}, M::kEstop},
    Transition{flyingBut({M::kDescend}), R::kNone, {C::kTetherBroken}, {}, {}, M::kDescend},
    Transition{maskOf({M::kFailsafe}), R::kNone, kSensorsBad, {C::kTimeInMode}, {}, M::kDescend},
    Transition{maskOf({M::kLand}), R::kNone, kBlind, {C::kTimeInMode}, {}, M::kDescend},
    Transition{flyingBut({M::kLand, M::kDescend}), R::kNone, kMustLand, {}, {}, M::kLand},
    Transition{maskOf({M::kTakeoff}), R::kNone, {C::kTimeInMode}, {}, {}, M::kLand},
    Transition{maskOf({M::kLand}), R::kNone, {C::kTetherSnagged}, {}, kMustLand, M::kFailsafe},
    Transition{maskOf({M::kFailsafe}), R::kNone, kUnsteady, {C::kTimeInMode}, kCaught, M::kLand},
    Transition{maskOf({M::kFailsafe}), R::kNone, kComeBack, {C::kTimeInMode, C::kNoWayBack}, kBlind | kCaught, M::kLand},
    Transition{maskOf({M::kFailsafe}), R::kNone, kComeBack, {C::kTimeInMode}, kBlind | kCaught, M::kReturn},
    Transition{kUnderWay | kGoingBack, R::kNone, kBlind | kUnsteady, {}, {}, M::kFailsafe},
    Transition{kUnderWay | maskOf({M::kReturn}), R::kNone, kCaught, {}, {}, M::kFailsafe},
    Transition{maskOf({M::kTeleop, M::kAuto}), R::kNone, kOutside, {}, {}, M::kFailsafe},
    Transition{maskOf({M::kAuto, M::kBackUp}), R::kNone, {C::kMissionFailed}, {}, {}, M::kFailsafe},
    Transition{maskOf({M::kReturn}), R::kNone, {C::kMissionFailed}, {}, {}, M::kLand},
    Transition{maskOf({M::kTeleop, M::kAuto}), R::kNone, {C::kOperatorLost}, {}, {}, M::kFailsafe},
    Transition{maskOf({M::kTeleop}), R::kNone, {C::kNoOperator}, {}, {}, M::kFailsafe},
    Transition{maskOf({M::kHold, M::kTeleop, M::kAuto}), R::kNone, {C::kBatteryLow}, {C::kNoWayBack}, {}, M::kLand},
    Transition{maskOf({M::kHold, M::kTeleop, M::kAuto}), R::kNone, {C::kBatteryLow}, {}, {}, M::kReturn},
    Transition{maskOf({M::kAuto}), R::kNone, {}, {C::kMissionDone, C::kNoOperator}, {C::kNoWayBack}, M::kReturn},
    Transition{maskOf({M::kAuto}), R::kNone, {C::kMissionDone, C::kSticksMoved}, {}, {}, M::kHold},
    Transition{maskOf({M::kTakeoff}), R::kNone, {C::kAtTarget}, {C::kVehicleFlying}, {}, M::kHold},
    Transition{maskOf({M::kReturn}), R::kNone, {C::kOperatorLost, C::kNoOperator, C::kBatteryLow}, {C::kAtTarget}, {}, M::kLand},
    Transition{maskOf({M::kBackUp}), R::kNone, kCaught, {C::kAtTarget}, {}, M::kFailsafe},
    Transition{kGoingBack, R::kNone, {C::kAtTarget}, {}, {}, M::kHold},
    Transition{maskOf({M::kArmed}), R::kNone, kNotReady | ConditionSet{C::kTimeInMode}, {}, {}, M::kStandby},
    // On request.
    Transition{kEveryMode, R::kEstop, {}, {}, {}, M::kEstop},
    Transition{maskOf({M::kStandby}), R::kArm, {}, {}, kNotReady, M::kArmed},
    Transition{maskOf({M::kArmed, M::kEstop}), R::kDisarm, {}, {}, {C::kVehicleFlying}, M::kStandby},
    Transition{maskOf({M::kArmed}), R::kTakeoff, {}, {}, kNotReady, M::kTakeoff},
    Transition{maskOf({M::kHold, M::kTeleop}), R::kNavigate, {}, {C::kMissionLoaded, C::kVehicleFlying}, kComeBack | ConditionSet{C::kTetherElsewhere}, M::kAuto},
    Transition{flyingBut({M::kHold, M::kFailsafe, M::kLand, M::kDescend}), R::kHold, {}, {C::kVehicleFlying}, {}, M::kHold},
    Transition{maskOf({M::kFailsafe, M::kLand, M::kDescend}), R::kHold, {}, {C::kVehicleFlying}, kBlind | kMustLand | kCaught | kUnsteady | ConditionSet{C::kTetherBroken, C::kBatteryLow}, M::kHold},
    Transition{flyingBut({M::kTakeoff, M::kDescend}), R::kTeleop, {}, {C::kVehicleFlying}, kBlind | kMustLand | kCaught | kUnsteady | kOutside | ConditionSet{C::kNoOperator, C::kOperatorLost, C::kBatteryLow}, M::kTeleop},
    Transition{flyingBut({M::kTakeoff, M::kReturn, M::kLand, M::kDescend}), R::kBackUp, {}, {C::kVehicleFlying}, kBlind | kMustLand | kUnsteady | ConditionSet{C::kNoWayBack}, M::kBackUp},
    Transition{flyingBut({M::kDescend}), R::kReturn, {}, {C::kVehicleFlying}, kBlind | kMustLand | kCaught | kUnsteady | ConditionSet{C::kNoWayBack}, M::kReturn},
    Transition{flyingBut({M::kDescend}), R::kLand, {}, {}, {}, M::kLand},
    Transition{kFlyingModes, R::kStop, {}, {}, {}, M::kFailsafe},
    // A station that was restarted in flight takes the vehicle back, disarmed until asked.
    Transition{maskOf({M::kStandby}), R::kHold, {}, {C::kVehicleFlying}, kBlind, M::kHold},
    Transition{maskOf({M::kStandby}), R::kLand, {}, {C::kVehicleFlying}, kBlind, M::kLand},
};
// clang-format on

bool applies(const Transition& row, Mode mode, ConditionSet conditions) noexcept {
  if (!isIn(mode, row.from) || row.to == mode) return false;
  return (row.when_any.empty() || conditions.any(row.when_any)) && conditions.all(row.when_all) &&
         !conditions.any(row.unless);
}

/// First row for `request` (kNone: by itself) that leads out of `mode`, or nullptr.
const Transition* firstFit(Request request, Mode mode, ConditionSet conditions) noexcept {
  for (const Transition& row : kTransitions)
    if (row.request == request && applies(row, mode, conditions)) return &row;
  return nullptr;
}

/// Asks for something that one should have seen the present mode for.
bool isBold(Request request) noexcept {
  return request == R::kArm || request == R::kDisarm || request == R::kTakeoff ||
         request == R::kNavigate || request == R::kTeleop;
}

/// What is there and must not be, and what is missing, for a request that was refused.
ConditionSet inTheWayOf(Request request, Mode mode, ConditionSet conditions) noexcept {
  for (const Transition& row : kTransitions)
    if (row.request == request && isIn(mode, row.from))
      return (conditions & row.unless) | row.when_all.without(conditions);
  return {};
}

/// A request that asks for the mode the station is already in is taken, not refused.
bool alreadyThere(Request request, Mode mode) noexcept {
  for (const Transition& row : kTransitions)
    if (row.request == request && row.to == mode) return true;
  return false;
}

}  // namespace

const Transition* transitionTable(int& count) noexcept {
  count = static_cast<int>(kTransitions.size());
  return kTransitions.data();
}

bool Supervisor::timedOut(Duration time_in_mode) const noexcept {
  const double seconds = toSeconds(time_in_mode);
  return (mode_ == M::kTakeoff && seconds > config_.takeoff_timeout_s) ||
         (mode_ == M::kArmed && seconds > config_.armed_timeout_s) ||
         (mode_ == M::kFailsafe && seconds > config_.failsafe_timeout_s) ||
         (mode_ == M::kLand && seconds > config_.land_timeout_s);
}

void Supervisor::enter(Mode mode, Time now, ConditionSet reasons) noexcept {
  mode_ = mode;
  entered_ = now;
  reasons_ = reasons;
}

SupervisorOutput Supervisor::step(Time now, ConditionSet conditions, Request request) noexcept {
  if (!started_) {
    entered_ = now;
    started_ = true;
  }
  conditions.set(C::kTimeInMode, timedOut(now - entered_));
  // The route that failed has gone with its mode; the second stage still has to know.
  if (mode_ == M::kFailsafe) conditions = conditions | (reasons_ & ConditionSet{C::kMissionFailed});

  // What happens by itself first, then the request, from where that has led.
  SupervisorOutput out;
  const Mode before = mode_;
  if (const Transition* row = firstFit(R::kNone, mode_, conditions))
    enter(row->to, now, conditions & (row->when_any | row->when_all));
  if (request != R::kNone) {
    const bool too_late = mode_ != before && isBold(request);
    const Transition* row = too_late ? nullptr : firstFit(request, mode_, conditions);
    if (row != nullptr) enter(row->to, now, {});
    out.request_taken = row != nullptr || alreadyThere(request, mode_);
    if (!out.request_taken) out.refusal = inTheWayOf(request, mode_, conditions);
  }
  out.changed = mode_ != before;
  out.mode = mode_;
  out.reasons = reasons_;
  out.time_in_mode = now - entered_;
  return out;
}

}  // namespace tautline
