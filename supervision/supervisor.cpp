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
/// Something holds the tether: moving on makes it worse.
constexpr ConditionSet kCaught{C::kTetherSnagged, C::kUnplannedContact, C::kOverTension};
/// The flight is not under control.
constexpr ConditionSet kUnsteady{C::kTetherSlack, C::kOscillation, C::kOverruns, C::kClockJump};
constexpr ConditionSet kNotReady = conditionsOf(ConditionKind::kForbidsArming);

constexpr ModeMask kUnderWay = maskOf({M::kTakeoff, M::kHold, M::kTeleop, M::kAuto});
constexpr ModeMask kGoingBack = maskOf({M::kBackUp, M::kReturn});

// clang-format off
constexpr std::array kTransitions{
    // The operator's emergency stop comes before everything else.
    Transition{kEveryMode, R::kEstop, {}, {}, {}, M::kEstop},
    // By themselves, most severe first.
    Transition{kFlyingModes, R::kNone, {C::kTouchdown}, {}, {C::kVehicleFlying}, M::kStandby},
    Transition{kFlyingModes, R::kNone, {C::kVehicleDanger}, {}, {}, M::kEstop},
    Transition{static_cast<ModeMask>(kFlyingModes & ~maskOf({M::kDescend})), R::kNone, {C::kTetherBroken}, {}, {}, M::kDescend},
    Transition{maskOf({M::kFailsafe}), R::kNone, kSensorsBad, {C::kTimeInMode}, {}, M::kDescend},
    Transition{static_cast<ModeMask>(kFlyingModes & ~maskOf({M::kLand, M::kDescend})), R::kNone, kMustLand, {}, {}, M::kLand},
    Transition{maskOf({M::kTakeoff}), R::kNone, {C::kTimeInMode}, {}, {}, M::kLand},
    Transition{maskOf({M::kFailsafe}), R::kNone, kUnsteady, {C::kTimeInMode}, kCaught, M::kLand},
    Transition{maskOf({M::kLand}), R::kNone, {C::kTetherSnagged}, {}, kMustLand, M::kFailsafe},
    Transition{maskOf({M::kFailsafe}), R::kNone, kOutside | ConditionSet{C::kOperatorLost, C::kMissionFailed}, {C::kTimeInMode}, kBlind | kCaught, M::kReturn},
    Transition{maskOf({M::kHold, M::kTeleop, M::kAuto}), R::kNone, {C::kBatteryLow}, {}, kBlind | kCaught, M::kReturn},
    Transition{kUnderWay | kGoingBack, R::kNone, kBlind | kUnsteady, {}, {}, M::kFailsafe},
    Transition{kUnderWay | maskOf({M::kReturn}), R::kNone, kCaught, {}, {}, M::kFailsafe},
    Transition{maskOf({M::kTeleop, M::kAuto}), R::kNone, kOutside, {}, {}, M::kFailsafe},
    Transition{maskOf({M::kAuto, M::kBackUp, M::kReturn}), R::kNone, {C::kMissionFailed}, {}, {}, M::kFailsafe},
    Transition{maskOf({M::kTeleop}), R::kNone, {C::kOperatorLost, C::kNoOperator}, {}, {}, M::kFailsafe},
    Transition{maskOf({M::kAuto}), R::kNone, {C::kMissionDone, C::kSticksMoved}, {}, {}, M::kHold},
    Transition{maskOf({M::kTakeoff}), R::kNone, {C::kAtTarget}, {C::kVehicleFlying}, {}, M::kHold},
    Transition{maskOf({M::kBackUp}), R::kNone, {C::kAtTarget}, {}, {}, M::kHold},
    Transition{maskOf({M::kReturn}), R::kNone, {C::kOperatorLost, C::kNoOperator, C::kBatteryLow}, {C::kAtTarget}, {}, M::kLand},
    Transition{maskOf({M::kReturn}), R::kNone, {C::kAtTarget}, {}, {}, M::kHold},
    Transition{maskOf({M::kArmed}), R::kNone, kNotReady | ConditionSet{C::kTimeInMode}, {}, {}, M::kStandby},
    // On request.
    Transition{maskOf({M::kStandby}), R::kArm, {}, {}, kNotReady, M::kArmed},
    Transition{maskOf({M::kArmed, M::kEstop}), R::kDisarm, {}, {}, {C::kVehicleFlying}, M::kStandby},
    Transition{maskOf({M::kArmed}), R::kTakeoff, {}, {}, kNotReady, M::kTakeoff},
    Transition{maskOf({M::kHold, M::kTeleop}), R::kNavigate, {}, {C::kMissionLoaded, C::kVehicleFlying}, {C::kTetherElsewhere}, M::kAuto},
    Transition{maskOf({M::kTakeoff, M::kTeleop, M::kAuto, M::kBackUp, M::kReturn}), R::kHold, {}, {C::kVehicleFlying}, {}, M::kHold},
    Transition{maskOf({M::kFailsafe, M::kLand, M::kDescend}), R::kHold, {}, {C::kVehicleFlying}, kBlind | kMustLand | kCaught | kUnsteady | ConditionSet{C::kTetherBroken}, M::kHold},
    Transition{maskOf({M::kHold, M::kAuto, M::kFailsafe, M::kBackUp, M::kReturn, M::kLand}), R::kTeleop, {}, {C::kVehicleFlying}, kBlind | kMustLand | kUnsteady | ConditionSet{C::kNoOperator, C::kOperatorLost}, M::kTeleop},
    Transition{maskOf({M::kHold, M::kTeleop, M::kAuto, M::kFailsafe}), R::kBackUp, {}, {C::kVehicleFlying}, kBlind | kMustLand | kUnsteady, M::kBackUp},
    Transition{maskOf({M::kTakeoff, M::kHold, M::kTeleop, M::kAuto, M::kFailsafe, M::kBackUp, M::kLand}), R::kReturn, {}, {C::kVehicleFlying}, kBlind | kMustLand | kCaught | kUnsteady, M::kReturn},
    Transition{static_cast<ModeMask>(kFlyingModes & ~maskOf({M::kLand, M::kDescend})), R::kLand, {}, {}, {}, M::kLand},
    Transition{static_cast<ModeMask>(kFlyingModes & ~maskOf({M::kLand, M::kDescend})), R::kStop, {}, {}, {}, M::kFailsafe},
    // A station that was restarted in flight takes the vehicle back, disarmed until asked.
    Transition{maskOf({M::kStandby}), R::kHold, {}, {C::kVehicleFlying}, kBlind, M::kHold},
    Transition{maskOf({M::kStandby}), R::kLand, {}, {C::kVehicleFlying}, kBlind, M::kLand},
};
// clang-format on

bool applies(const Transition& row, Mode mode, ConditionSet conditions) noexcept {
  if (!isIn(mode, row.from)) return false;
  return (row.when_any.empty() || conditions.any(row.when_any)) && conditions.all(row.when_all) &&
         !conditions.any(row.unless);
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
         (mode_ == M::kFailsafe && seconds > config_.failsafe_timeout_s);
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

  SupervisorOutput out;
  const Mode before = mode_;
  for (const Transition& row : kTransitions) {
    const bool automatic = row.request == R::kNone;
    if (!automatic && row.request != request) continue;
    if (row.to == mode_ && !automatic) continue;
    if (!applies(row, mode_, conditions)) continue;
    enter(row.to, now, automatic ? conditions & (row.when_any | row.when_all) : ConditionSet{});
    out.request_taken = !automatic;
    break;
  }
  out.changed = mode_ != before;

  if (request != R::kNone && !out.request_taken) {
    if (alreadyThere(request, mode_)) {
      out.request_taken = true;
    } else {
      for (const Transition& row : kTransitions) {
        if (row.request != request || !isIn(mode_, row.from)) continue;
        out.refusal = (conditions & row.unless) | row.when_all.without(conditions);
      }
    }
  }
  out.mode = mode_;
  out.reasons = reasons_;
  out.time_in_mode = now - entered_;
  return out;
}

}  // namespace tautline
