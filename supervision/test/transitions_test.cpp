/// @file
/// Every mode × every request × every set of up to two conditions, before and after the mode's
/// time-out, against rules that are stated here independently of the table.

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "supervision/supervisor.h"
#include "supervision/test/driven.h"

namespace tautline {
namespace {

using C = Condition;
using M = Mode;
using R = Request;

/// How far a mode is down the ladder of docs/supervisor.md.
int rungOf(Mode mode) {
  switch (mode) {
    case M::kFailsafe:
      return 1;
    case M::kBackUp:
      return 2;
    case M::kReturn:
      return 3;
    case M::kLand:
      return 4;
    case M::kDescend:
      return 5;
    case M::kEstop:
      return 6;
    default:
      return 0;
  }
}

/// The least that each condition asks for in flight, as safety is specified.
struct Demand {
  Condition condition;
  Mode at_least;
};
const std::vector<Demand> kDemands{
    {C::kVehicleDanger, M::kEstop},    {C::kTetherBroken, M::kDescend},
    {C::kLinkLost, M::kLand},          {C::kVehicleStale, M::kLand},
    {C::kVehicleFault, M::kLand},      {C::kBatteryCritical, M::kLand},
    {C::kTetherPowerLost, M::kLand},   {C::kReelStale, M::kFailsafe},
    {C::kReelStuck, M::kFailsafe},     {C::kReelJump, M::kFailsafe},
    {C::kAnglesStale, M::kFailsafe},   {C::kAnglesStuck, M::kFailsafe},
    {C::kAnglesJump, M::kFailsafe},    {C::kLocalizationLost, M::kFailsafe},
    {C::kTetherSlack, M::kFailsafe},   {C::kOverTension, M::kFailsafe},
    {C::kTetherSnagged, M::kFailsafe}, {C::kUnplannedContact, M::kFailsafe},
    {C::kContactLost, M::kFailsafe},   {C::kContactNotFormed, M::kFailsafe},
    {C::kOscillation, M::kFailsafe},   {C::kOverruns, M::kFailsafe},
    {C::kClockJump, M::kFailsafe},
};
/// The same for missions and sticks only.
const std::vector<Demand> kDemandsUnderWay{
    {C::kFenceLength, M::kFailsafe},    {C::kFenceAltitude, M::kFailsafe},
    {C::kFenceElevation, M::kFailsafe}, {C::kFenceKeepOut, M::kFailsafe},
    {C::kFenceClearance, M::kFailsafe}, {C::kOperatorLost, M::kFailsafe},
    {C::kBatteryLow, M::kReturn},
};
/// These hold back RETURN or LAND: to move on would make it worse.
const ConditionSet kHoldsBack{
    C::kReelStale,      C::kReelStuck,        C::kReelJump,         C::kAnglesStale,
    C::kAnglesStuck,    C::kAnglesJump,       C::kTetherSlack,      C::kOscillation,
    C::kOverruns,       C::kClockJump,        C::kLocalizationLost, C::kTetherSnagged,
    C::kOverTension,    C::kUnplannedContact, C::kContactLost,      C::kContactNotFormed,
    C::kFenceLength,    C::kFenceAltitude,    C::kFenceElevation,   C::kFenceKeepOut,
    C::kFenceClearance, C::kOperatorLost,     C::kNoOperator,       C::kMissionFailed};

struct Case {
  Mode from;
  Request request;
  ConditionSet set;
  bool timed_out;
};
std::string nameOf(const Case& c) {
  return std::string(tautline::nameOf(c.from, kModeNames)) + (c.timed_out ? " (for long)" : "") +
         " + " + tautline::nameOf(c.request, kRequestNames) + " + " + describe(c.set);
}
SupervisorOutput outcomeOf(const Case& c) {
  Driven d = drivenTo(c.from);
  return d.step(c.set, c.request,
                c.timed_out ? std::chrono::seconds(1000) : std::chrono::milliseconds(10));
}

template <class Check>
void forEachCase(Mode from, const std::vector<Request>& requests, const Check& check) {
  const auto at = [](std::size_t i) { return kConditionInfos[i].condition; };
  for (const bool timed_out : {false, true})
    for (const Request request : requests) {
      check(Case{from, request, {}, timed_out});
      for (std::size_t i = 0; i < kConditionCount; ++i)
        for (std::size_t j = i; j < kConditionCount; ++j)
          for (const bool flying : {false, true}) {
            ConditionSet set{at(i), at(j)};
            if (flying) set.set(C::kVehicleFlying);
            check(Case{from, request, set, timed_out});
          }
    }
}

std::vector<Request> allRequests() {
  std::vector<Request> requests;
  for (const auto& entry : kRequestNames) requests.push_back(entry.value);
  return requests;
}

class EveryMode : public ::testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, EveryMode,
                         ::testing::Values(M::kStandby, M::kArmed, M::kTakeoff, M::kHold,
                                           M::kTeleop, M::kAuto, M::kFailsafe, M::kBackUp,
                                           M::kReturn, M::kLand, M::kDescend, M::kEstop),
                         [](const auto& param_info) {
                           return tautline::nameOf(param_info.param, kModeNames);
                         });

TEST_P(EveryMode, IsReached) { EXPECT_EQ(drivenTo(GetParam()).supervisor.mode(), GetParam()); }

TEST_P(EveryMode, MakesNoUnsafeTransition) {
  forEachCase(GetParam(), allRequests(), [](const Case& c) {
    const SupervisorOutput out = outcomeOf(c);
    const bool entered = out.mode != c.from;
    ASSERT_LT(static_cast<std::size_t>(out.mode), kModeNames.size()) << nameOf(c);
    if (c.request == R::kEstop) {
      ASSERT_EQ(out.mode, M::kEstop) << nameOf(c);
    }
    if (c.from == M::kEstop && entered) {
      ASSERT_EQ(out.mode, M::kStandby) << nameOf(c);
      ASSERT_EQ(c.request, R::kDisarm) << nameOf(c);
      ASSERT_FALSE(c.set.has(C::kVehicleFlying)) << nameOf(c);
    }
    // Motors start, sticks and missions are followed on request alone, and never with a reason
    // against it.
    if (entered && (out.mode == M::kArmed || out.mode == M::kTakeoff)) {
      ASSERT_EQ(c.request, out.mode == M::kArmed ? R::kArm : R::kTakeoff) << nameOf(c);
      ASSERT_EQ(c.from, out.mode == M::kArmed ? M::kStandby : M::kArmed) << nameOf(c);
      ASSERT_TRUE((c.set & conditionsOf(ConditionKind::kForbidsArming)).empty()) << nameOf(c);
    }
    if (entered && out.mode == M::kAuto) {
      ASSERT_EQ(c.request, R::kNavigate) << nameOf(c);
      ASSERT_TRUE(c.set.has(C::kMissionLoaded) && !c.set.has(C::kTetherElsewhere)) << nameOf(c);
    }
    if (entered && out.mode == M::kTeleop) {
      ASSERT_EQ(c.request, R::kTeleop) << nameOf(c);
    }
    // On the ground nothing flies by itself; in the air only the vehicle itself ends the flight.
    if (!isIn(c.from, kFlyingModes) && isIn(out.mode, kFlyingModes)) {
      ASSERT_TRUE(out.request_taken) << nameOf(c);
    }
    if (isIn(c.from, kFlyingModes) && !isIn(out.mode, kFlyingModes) && out.mode != M::kEstop) {
      ASSERT_EQ(out.mode, M::kStandby) << nameOf(c);
      ASSERT_TRUE(c.set.has(C::kTouchdown) && !c.set.has(C::kVehicleFlying)) << nameOf(c);
    }
    // What nobody asked for has a reason; what was asked for is taken or refused, never forgotten.
    if (entered && !out.request_taken) {
      ASSERT_FALSE(out.reasons.empty()) << nameOf(c);
    }
    if (c.request == R::kNone) {
      ASSERT_FALSE(out.request_taken) << nameOf(c);
    }
  });
}

TEST_P(EveryMode, DoesWhatEachConditionDemands) {
  if (!isIn(GetParam(), kFlyingModes)) return;
  const bool under_way = isIn(GetParam(), maskOf({M::kTeleop, M::kAuto}));
  forEachCase(GetParam(), {R::kNone}, [&](const Case& c) {
    if (c.set.has(C::kTouchdown) && !c.set.has(C::kVehicleFlying)) return;
    const int rung = rungOf(outcomeOf(c).mode);
    const auto demand = [&](const Demand& d) {
      if (!c.set.has(d.condition)) return;
      // Backing up is itself the way out of what holds the tether.
      if (c.from == M::kBackUp && rungOf(d.at_least) == 1) {
        ASSERT_GE(rung, 1) << nameOf(c);
        return;
      }
      const bool held_back = d.at_least == M::kReturn && !(c.set & kHoldsBack).empty() && rung >= 1;
      if (!held_back) {
        ASSERT_GE(rung, rungOf(d.at_least)) << nameOf(c);
      }
    };
    for (const Demand& d : kDemands) demand(d);
    if (under_way)
      for (const Demand& d : kDemandsUnderWay) demand(d);
  });
}

TEST_P(EveryMode, TheMostSevereOfTwoConditionsWins) {
  if (!isIn(GetParam(), kFlyingModes)) return;
  forEachCase(GetParam(), {R::kNone}, [](const Case& c) {
    const ConditionSet ends{C::kTouchdown, C::kAtTarget, C::kMissionDone};  // end a mode by itself
    if (c.set.any(ends) || !(c.set & kHoldsBack).empty()) return;
    const int both = rungOf(outcomeOf(c).mode);
    for (const ConditionInfo& info : kConditionInfos) {
      if (!c.set.has(info.condition)) continue;
      Case one = c;
      one.set = ConditionSet{info.condition} | (c.set & ConditionSet{C::kVehicleFlying});
      ASSERT_GE(both, rungOf(outcomeOf(one).mode)) << nameOf(c) << " against " << info.name;
    }
  });
}

// Whatever stays the case leads to one mode and stays there: no two rows that throw the mode to and
// fro. Time passes in the modes, so that second stages are in it.
TEST_P(EveryMode, ComesToRest) {
  forEachCase(GetParam(), {R::kNone}, [](const Case& c) {
    Driven d = drivenTo(c.from);
    int changes = 0;
    bool changed_late = false;
    for (int i = 0; i < 8; ++i) {
      const bool changed = d.step(c.set, R::kNone, std::chrono::seconds(200)).changed;
      changes += changed ? 1 : 0;
      changed_late = changed_late || (changed && i >= 5);
    }
    ASSERT_LE(changes, 4) << nameOf(c);
    ASSERT_FALSE(changed_late) << nameOf(c);
  });
}

// No dead end: whatever one condition has done, once it is gone the operator has the drone back,
// and it comes down.
TEST_P(EveryMode, LeadsHome) {
  for (const ConditionInfo& info : kConditionInfos) {
    Driven d = drivenTo(GetParam());
    d.step(ConditionSet{info.condition} | kFlying);
    d.step(ConditionSet{info.condition} | kFlying, R::kNone, std::chrono::seconds(60));
    if (isIn(d.supervisor.mode(), kFlyingModes)) {
      EXPECT_EQ(d.step(kFlying, R::kHold).mode, M::kHold) << info.name;
      EXPECT_EQ(d.step(kFlying, R::kLand).mode, M::kLand) << info.name;
      d.step({C::kTouchdown});
    }
    d.step({}, R::kDisarm);
    EXPECT_EQ(d.supervisor.mode(), M::kStandby) << info.name;
  }
}

// While a condition is there, the operator is never without a move that stops or lands the drone.
TEST_P(EveryMode, AlwaysLeavesTheOperatorAMove) {
  if (!isIn(GetParam(), kFlyingModes)) return;
  for (const ConditionInfo& info : kConditionInfos) {
    const ConditionSet set = ConditionSet{info.condition} | kFlying;
    EXPECT_EQ(drivenTo(GetParam()).step(set, R::kEstop).mode, M::kEstop) << info.name;
    const Mode asked = drivenTo(GetParam()).step(set, R::kLand).mode;
    EXPECT_GE(rungOf(asked), 1) << info.name;
  }
}

TEST(Transitions, EveryRowIsUsed) {
  int count = 0;
  const Transition* rows = transitionTable(count);
  std::vector<bool> used(static_cast<std::size_t>(count), false);
  // A row is used if in one of its modes the conditions it asks for lead where it says.
  for (int i = 0; i < count; ++i) {
    for (const auto& mode : kModeNames) {
      if (!isIn(mode.value, rows[i].from) || mode.value == rows[i].to) continue;
      for (const ConditionInfo& info : kConditionInfos) {
        if (!rows[i].when_any.empty() && !rows[i].when_any.has(info.condition)) continue;
        ConditionSet set = rows[i].when_all | kFlying.without(rows[i].unless);
        if (!rows[i].when_any.empty()) set.set(info.condition);
        const Case c{mode.value, rows[i].request, set, set.has(C::kTimeInMode)};
        if (outcomeOf(c).mode == rows[i].to) used[static_cast<std::size_t>(i)] = true;
      }
    }
    EXPECT_TRUE(used[static_cast<std::size_t>(i)])
        << "row " << i << " to " << tautline::nameOf(rows[i].to, kModeNames);
  }
}

}  // namespace
}  // namespace tautline
