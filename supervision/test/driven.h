#pragma once

/// @file
/// A supervisor that is stepped by hand, and brought into any mode.

#include "supervision/supervisor.h"

namespace tautline {

inline constexpr ConditionSet kFlying{Condition::kVehicleFlying};

struct Driven {
  Supervisor supervisor{SupervisorConfig{}};
  Time now{std::chrono::seconds(10)};

  SupervisorOutput step(ConditionSet conditions, Request request = Request::kNone,
                        Duration dt = std::chrono::milliseconds(10)) {
    now += dt;
    return supervisor.step(now, conditions, request);
  }
};

/// By the requests and conditions that lead there.
inline Driven drivenTo(Mode mode) {
  using R = Request;
  Driven d;
  d.step({});
  if (mode == Mode::kStandby) return d;
  if (mode == Mode::kEstop) {
    d.step({}, R::kEstop);
    return d;
  }
  d.step({}, R::kArm);
  if (mode == Mode::kArmed) return d;
  d.step({}, R::kTakeoff);
  if (mode == Mode::kTakeoff) return d;
  d.step(kFlying | ConditionSet{Condition::kAtTarget});
  switch (mode) {
    case Mode::kAuto:
      d.step(kFlying | ConditionSet{Condition::kMissionLoaded}, R::kNavigate);
      break;
    case Mode::kTeleop:
      d.step(kFlying, R::kTeleop);
      break;
    case Mode::kFailsafe:
      d.step(kFlying, R::kStop);
      break;
    case Mode::kBackUp:
      d.step(kFlying, R::kBackUp);
      break;
    case Mode::kReturn:
      d.step(kFlying, R::kReturn);
      break;
    case Mode::kLand:
      d.step(kFlying, R::kLand);
      break;
    case Mode::kDescend:
      d.step(kFlying | ConditionSet{Condition::kTetherBroken});
      break;
    default:
      break;
  }
  return d;
}

}  // namespace tautline
