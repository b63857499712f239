#include "supervision/supervisor.h"

#include <gtest/gtest.h>

#include "supervision/test/driven.h"

namespace tautline {
namespace {

using C = Condition;
using M = Mode;
using R = Request;
using std::chrono::seconds;

TEST(Supervisor, ComesUpDisarmed) {
  Supervisor s{SupervisorConfig{}};
  EXPECT_EQ(s.step(Time{}, {}, R::kNone).mode, M::kStandby);
}

TEST(Supervisor, StaleSensorEndsAMissionAndItNeverGoesOnByItself) {
  for (const C stale : {C::kReelStale, C::kAnglesStale, C::kLocalizationLost}) {
    Driven d = drivenTo(M::kAuto);
    const auto out = d.step(kFlying | ConditionSet{stale});
    EXPECT_EQ(out.mode, M::kFailsafe);
    EXPECT_TRUE(out.reasons.has(stale));
    EXPECT_EQ(d.step(kFlying, R::kNone, seconds(600)).mode, M::kFailsafe);
  }
}

TEST(Supervisor, SensorsThatStayAwayEndInDescend) {
  Driven d = drivenTo(M::kAuto);
  const ConditionSet blind = kFlying | ConditionSet{C::kAnglesStale};
  EXPECT_EQ(d.step(blind).mode, M::kFailsafe);
  EXPECT_EQ(d.step(blind, R::kNone, seconds(9)).mode, M::kFailsafe);
  EXPECT_EQ(d.step(blind, R::kNone, seconds(2)).mode, M::kDescend);
}

TEST(Supervisor, ASnaggedTetherIsNotLandedWith) {
  const ConditionSet snagged = kFlying | ConditionSet{C::kTetherSnagged};
  Driven d = drivenTo(M::kLand);
  EXPECT_EQ(d.step(snagged).mode, M::kFailsafe);
  EXPECT_EQ(d.step(snagged, R::kNone, seconds(600)).mode, M::kFailsafe) << "the operator decides";
  EXPECT_EQ(d.step(snagged, R::kBackUp).mode, M::kBackUp);
  EXPECT_EQ(d.step(snagged | ConditionSet{C::kBatteryCritical}).mode, M::kLand)
      << "it comes down anyway";
}

TEST(Supervisor, LosingTheOperatorHoldsThenReturnsThenLands) {
  const ConditionSet lost = kFlying | ConditionSet{C::kOperatorLost};
  Driven d = drivenTo(M::kTeleop);
  EXPECT_EQ(d.step(lost).mode, M::kFailsafe);
  EXPECT_EQ(d.step(lost, R::kNone, seconds(11)).mode, M::kReturn);
  EXPECT_EQ(d.step(lost | ConditionSet{C::kAtTarget}).mode, M::kLand);

  d = drivenTo(M::kTeleop);
  d.step(lost);
  EXPECT_EQ(d.step(lost | ConditionSet{C::kNoWayBack}, R::kNone, seconds(11)).mode, M::kLand);
}

TEST(Supervisor, AMissionThatFailsHoldsThenReturnsAndAReturnThatFailsLands) {
  Driven d = drivenTo(M::kAuto);
  EXPECT_EQ(d.step(kFlying | ConditionSet{C::kMissionFailed}).mode, M::kFailsafe);
  EXPECT_EQ(d.step(kFlying, R::kNone, seconds(11)).mode, M::kReturn);
  EXPECT_EQ(d.step(kFlying | ConditionSet{C::kMissionFailed}).mode, M::kLand);

  d = drivenTo(M::kAuto);
  d.step(kFlying | ConditionSet{C::kMissionFailed});
  EXPECT_EQ(d.step(kFlying, R::kHold).mode, M::kHold) << "the operator has taken over";
  EXPECT_EQ(d.step(kFlying, R::kNone, seconds(600)).mode, M::kHold);
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
  EXPECT_TRUE(drivenTo(M::kFailsafe).step(kFlying, R::kStop).request_taken);
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

TEST(Supervisor, EmergencyStopIsLatchedUntilDisarmedOnTheGround) {
  Driven d = drivenTo(M::kAuto);
  EXPECT_EQ(d.step(kFlying, R::kEstop).mode, M::kEstop);
  EXPECT_EQ(d.step(kFlying, R::kDisarm).mode, M::kEstop);
  EXPECT_EQ(d.step({}, R::kArm).mode, M::kEstop);
  EXPECT_EQ(d.step({}, R::kDisarm).mode, M::kStandby);
}

}  // namespace
}  // namespace tautline
