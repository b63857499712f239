#include "control/supervisor.h"

namespace tautline {
namespace {

constexpr std::uint16_t in(std::initializer_list<Mode> modes) noexcept {
  std::uint16_t mask = 0;
  for (const Mode m : modes)
    mask = static_cast<std::uint16_t>(mask | (1U << static_cast<unsigned>(m)));
  return mask;
}

using C = Condition;
using M = Mode;
using R = Request;

constexpr std::uint16_t kAirborne = in({M::kTakeoff, M::kHold, M::kAuto, M::kLand});
constexpr std::uint16_t kEverywhere = 0xFFFF;
constexpr ConditionSet kBlind{C::kReelStale, C::kAnglesStale, C::kLocalizationLost};
constexpr ConditionSet kNotReady{
    C::kReelStale,        C::kAnglesStale,  C::kAttitudeStale, C::kVehicleStale, C::kLinkLost,
    C::kLocalizationLost, C::kVehicleFault, C::kVehicleFlying, C::kOverruns,     C::kLinkFault};

// clang-format off
constexpr std::array kTransitions{
    // The operator's stop comes before everything else.
    Transition{kEverywhere, R::kStop, {}, {}, {}, M::kEstop},
    // By themselves, most severe first.
    Transition{kAirborne, R::kNone, {C::kTouchdown}, {}, {C::kVehicleFlying}, M::kStandby},
    Transition{in({M::kTakeoff, M::kHold, M::kAuto}), R::kNone, {C::kLinkLost, C::kVehicleStale, C::kVehicleFault}, {}, {}, M::kLand},
    Transition{in({M::kTakeoff}), R::kNone, {C::kTimeInMode}, {}, {}, M::kLand},
    Transition{in({M::kAuto}), R::kNone, kBlind | ConditionSet{C::kMissionFailed, C::kOverruns}, {}, {}, M::kHold},
    Transition{in({M::kAuto}), R::kNone, {C::kMissionDone}, {}, {}, M::kHold},
    Transition{in({M::kTakeoff}), R::kNone, {C::kAtTarget}, {C::kVehicleFlying}, {}, M::kHold},
    Transition{in({M::kArmed}), R::kNone, kNotReady | ConditionSet{C::kTimeInMode}, {}, {}, M::kStandby},
    // On request.
    Transition{in({M::kStandby}), R::kArm, {}, {}, kNotReady, M::kArmed},
    Transition{in({M::kArmed, M::kEstop}), R::kDisarm, {}, {}, {C::kVehicleFlying}, M::kStandby},
    Transition{in({M::kArmed}), R::kTakeoff, {}, {}, kNotReady, M::kTakeoff},
    Transition{in({M::kHold}), R::kNavigate, {}, {C::kMissionLoaded, C::kVehicleFlying}, kBlind | ConditionSet{C::kOverruns, C::kTetherElsewhere}, M::kAuto},
    Transition{in({M::kTakeoff, M::kAuto, M::kLand}), R::kHold, {}, {C::kVehicleFlying}, {}, M::kHold},
    Transition{in({M::kTakeoff, M::kHold, M::kAuto}), R::kLand, {}, {}, {}, M::kLand},
    // A station that was restarted in flight takes the vehicle back, disarmed until asked.
    Transition{in({M::kStandby}), R::kHold, {}, {C::kVehicleFlying}, kBlind, M::kHold},
    Transition{in({M::kStandby}), R::kLand, {}, {C::kVehicleFlying}, kBlind, M::kLand},
};
// clang-format on

bool applies(const Transition& row, Mode mode, ConditionSet conditions) noexcept {
  if ((row.from & (1U << static_cast<unsigned>(mode))) == 0) return false;
  return (row.when_any.empty() || conditions.any(row.when_any)) && conditions.all(row.when_all) &&
         !conditions.any(row.unless);
}

/// A request that asks for the mode the station is already in is taken, not refused.
bool alreadyThere(Request request, Mode mode) noexcept {
  return (request == R::kHold && mode == M::kHold) || (request == R::kLand && mode == M::kLand) ||
         (request == R::kArm && mode == M::kArmed) ||
         (request == R::kDisarm && mode == M::kStandby) ||
         (request == R::kTakeoff && mode == M::kTakeoff);
}

}  // namespace

const Transition* transitionTable(int& count) noexcept {
  count = static_cast<int>(kTransitions.size());
  return kTransitions.data();
}

std::string describe(ConditionSet set) {
  std::string text;
  for (const auto& entry : kConditionNames) {
    if (!set.has(entry.value)) continue;
    if (!text.empty()) text += ' ';
    text += entry.name;
  }
  return text;
}

bool Supervisor::timedOut(Duration time_in_mode) const noexcept {
  const double seconds = toSeconds(time_in_mode);
  return (mode_ == M::kTakeoff && seconds > config_.takeoff_timeout_s) ||
         (mode_ == M::kArmed && seconds > config_.armed_timeout_s);
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
    if (alreadyThere(request, mode_) || (request == R::kStop && mode_ == M::kEstop)) {
      out.request_taken = true;
    } else {
      for (const Transition& row : kTransitions) {
        if (row.request != request || (row.from & (1U << static_cast<unsigned>(mode_))) == 0)
          continue;
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
