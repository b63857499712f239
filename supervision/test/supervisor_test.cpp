#include "supervision/supervisor.h"

#include <vector>

#include <gtest/gtest.h>

namespace tautline {
namespace {

using C = Condition;
using M = Mode;
using R = Request;
using std::chrono::milliseconds;
using std::chrono::seconds;

const ConditionSet kFlying{C::kVehicleFlying};

/// A supervisor that has been brought into `mode` by the requests and conditions that lead there.
struct Driven {
  Supervisor supervisor{SupervisorConfig{}};
  Time now{seconds(10)};

  SupervisorOutput step(ConditionSet conditions, Request request = R::kNone) {
    now += milliseconds(10);
    return supervisor.step(now, conditions, request);
  }
};

Driven drivenTo(Mode mode) {
  Driven d;
  d.step({});
  if (mode == M::kStandby) return d;
  if (mode == M::kEstop) {
    d.step({}, R::kEstop);
    return d;
  }
  d.step({}, R::kArm);
  if (mode == M::kArmed) return d;
  d.step({}, R::kTakeoff);
  if (mode == M::kTakeoff) return d;
  d.step(kFlying | ConditionSet{C::kAtTarget});
  if (mode == M::kHold) return d;
  if (mode == M::kAuto) {
    d.step(kFlying | ConditionSet{C::kMissionLoaded}, R::kNavigate);
  } else {
    d.step(kFlying, R::kLand);
  }
  return d;
}

TEST(Supervisor, ReachesEveryMode) {
  for (const auto& entry : kModeNames)
    EXPECT_EQ(drivenTo(entry.value).supervisor.mode(), entry.value) << entry.name;
}

TEST(Supervisor, ComesUpDisarmed) {
  Supervisor s{SupervisorConfig{}};
  EXPECT_EQ(s.step(Time{}, {}, R::kNone).mode, M::kStandby);
}

// Independent statement of what must hold, whatever the table says: checked for every mode, every
// request and every set of up to three conditions at once.
class AllCases : public ::testing::TestWithParam<Mode> {};

TEST_P(AllCases, EndInASafeMode) {
  const Mode from = GetParam();
  const int n = static_cast<int>(kConditionInfos.size());
  int cases = 0;
  for (const auto& request : kRequestNames) {
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j) {
        for (int k = j; k < n; ++k) {
          ConditionSet set{kConditionInfos[static_cast<std::size_t>(i)].condition,
                           kConditionInfos[static_cast<std::size_t>(j)].condition,
                           kConditionInfos[static_cast<std::size_t>(k)].condition};
          Driven d = drivenTo(from);
          const SupervisorOutput out = d.step(set, request.value);
          ++cases;
          const std::string what =
              std::string(nameOf(from, kModeNames)) + " + " + request.name + " + " + describe(set);

          if (request.value == R::kEstop || (from == M::kEstop && request.value != R::kDisarm)) {
            EXPECT_EQ(out.mode, M::kEstop) << what;
          }
          // Nothing starts motors or missions by itself, and nothing arms while something is wrong.
          if (out.mode == M::kTakeoff && from != M::kTakeoff) {
            EXPECT_EQ(request.value, R::kTakeoff) << what;
            EXPECT_EQ(from, M::kArmed) << what;
          }
          if (out.mode == M::kArmed && from != M::kArmed) {
            EXPECT_EQ(request.value, R::kArm) << what;
            EXPECT_TRUE((set & ConditionSet{C::kReelStale, C::kAnglesStale, C::kLinkLost,
                                            C::kLinkFault, C::kVehicleFault})
                            .empty())
                << what;
          }
          if (out.mode == M::kAuto) {
            EXPECT_FALSE(set.has(C::kReelStale) || set.has(C::kAnglesStale) ||
                         set.has(C::kLocalizationLost) ||
                         (from == M::kAuto && set.has(C::kMissionFailed)))
                << what;
            if (from != M::kAuto) {
              EXPECT_TRUE(set.has(C::kMissionLoaded) && request.value == R::kNavigate) << what;
            }
          }
          // A lost link never leaves a mission or a hover going on.
          if (set.has(C::kLinkLost) && request.value == R::kNone && !set.has(C::kTouchdown) &&
              (from == M::kTakeoff || from == M::kHold || from == M::kAuto)) {
            EXPECT_EQ(out.mode, M::kLand) << what;
          }
          // Disarmed in the air only where the vehicle itself is down.
          if (out.mode == M::kStandby &&
              (from == M::kHold || from == M::kAuto || from == M::kLand || from == M::kTakeoff)) {
            EXPECT_TRUE(set.has(C::kTouchdown) && !set.has(C::kVehicleFlying)) << what;
          }
          // A change that nobody asked for has a reason.
          if (out.changed && !out.request_taken) {
            EXPECT_FALSE(out.reasons.empty()) << what;
          }
        }
      }
    }
  }
  EXPECT_EQ(cases, 8 * n * (n + 1) * (n + 2) / 6);
}
INSTANTIATE_TEST_SUITE_P(Modes, AllCases,
                         ::testing::Values(M::kStandby, M::kArmed, M::kTakeoff, M::kHold, M::kAuto,
                                           M::kLand, M::kEstop),
                         [](const auto& param_info) {
                           return nameOf(param_info.param, kModeNames);
                         });

TEST(Supervisor, StaleSensorEndsAMissionInHold) {
  for (const C stale : {C::kReelStale, C::kAnglesStale, C::kLocalizationLost}) {
    Driven d = drivenTo(M::kAuto);
    const auto out = d.step(kFlying | ConditionSet{stale});
    EXPECT_EQ(out.mode, M::kHold);
    EXPECT_TRUE(out.reasons.has(stale));
    EXPECT_EQ(d.step(kFlying).mode, M::kHold) << "a mission never goes on by itself";
  }
}

TEST(Supervisor, RefusalNamesWhatIsInTheWay) {
  Driven d = drivenTo(M::kStandby);
  auto out = d.step(ConditionSet{C::kReelStale, C::kLinkLost}, R::kArm);
  EXPECT_FALSE(out.request_taken);
  EXPECT_EQ(out.refusal, (ConditionSet{C::kReelStale, C::kLinkLost}));

  d = drivenTo(M::kHold);
  out = d.step(kFlying, R::kNavigate);
  EXPECT_FALSE(out.request_taken);
  EXPECT_EQ(out.refusal, ConditionSet{C::kMissionLoaded})
      << "what is missing counts as a reason too";

  out = drivenTo(M::kStandby).step({}, R::kTakeoff);
  EXPECT_FALSE(out.request_taken);
  EXPECT_TRUE(out.refusal.empty()) << "the mode itself does not allow it";
}

TEST(Supervisor, AskingForWhatIsAlreadySoIsTaken) {
  EXPECT_TRUE(drivenTo(M::kHold).step(kFlying, R::kHold).request_taken);
  EXPECT_TRUE(drivenTo(M::kLand).step(kFlying, R::kLand).request_taken);
  EXPECT_TRUE(drivenTo(M::kArmed).step({}, R::kArm).request_taken);
  EXPECT_TRUE(drivenTo(M::kEstop).step({}, R::kEstop).request_taken);
}

TEST(Supervisor, TimesOutOfArmedAndTakeoff) {
  Driven d = drivenTo(M::kArmed);
  d.now += seconds(121);
  EXPECT_EQ(d.step({}).mode, M::kStandby);
  d = drivenTo(M::kTakeoff);
  d.now += seconds(31);
  EXPECT_EQ(d.step(kFlying).mode, M::kLand);
}

TEST(Supervisor, StopIsLatchedUntilDisarmedOnTheGround) {
  Driven d = drivenTo(M::kAuto);
  EXPECT_EQ(d.step(kFlying, R::kEstop).mode, M::kEstop);
  EXPECT_EQ(d.step(kFlying, R::kDisarm).mode, M::kEstop);
  EXPECT_EQ(d.step({}, R::kArm).mode, M::kEstop);
  EXPECT_EQ(d.step({}, R::kDisarm).mode, M::kStandby);
}

TEST(ConditionSet, DescribesInOrder) {
  EXPECT_EQ(describe(ConditionSet{C::kLinkLost, C::kReelStale}), "REEL_STALE LINK_LOST");
  EXPECT_EQ(describe(ConditionSet{}), "");
}

}  // namespace
}  // namespace tautline
