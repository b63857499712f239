// Operators' dealings with the whole core: lease, repeats, parameters, faults.

#include "app/station/operator_dialogue.h"

#include <cmath>
#include <memory>
#include <string_view>

#include <gtest/gtest.h>

#include "app/station/station.h"
#include "app/station/station_config.h"
#include "common/testing/malloc_guard.h"

namespace tautline {
namespace {

using A = AckResult;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::int64_t kAnna = 11;
constexpr std::int64_t kBert = 22;

struct Desk {
  CoreConfig config;
  MissionStore missions;
  OperatorDialogue operators{config, missions};
  StepInput in;
  Mode mode{Mode::kStandby};
  std::int64_t sequence{0};

  Desk() { in.now = Time{seconds(10)}; }

  Request take(const OperatorCommand& command) {
    in.now += milliseconds(10);
    in.command = command;
    return operators.take(in, mode);
  }
  A ask(std::int64_t session, OperatorCommand command) {
    command.session = session;
    command.sequence = ++sequence;
    SupervisorOutput decision;
    decision.request_taken = take(command) != Request::kNone;
    operators.answer(in.now, decision);
    return operators.ack() ? operators.ack()->result : A::kMalformed;
  }
  A set(std::string_view key, double value) {
    return ask(
        kAnna,
        {.service = Service::kSetParameter, .parameter = parameterHash(key), .value = value});
  }
};

TEST(OperatorDialogue, ARepeatGetsTheSameAnswerAndActsOnce) {
  Desk desk;
  const OperatorCommand arm{.session = kAnna, .sequence = 7, .request = Request::kArm};
  EXPECT_EQ(desk.take(arm), Request::kArm);
  SupervisorOutput refused;
  refused.refusal = {Condition::kReelStale};
  desk.operators.answer(desk.in.now, refused);
  EXPECT_EQ(desk.take(arm), Request::kNone);
  desk.operators.answer(desk.in.now, SupervisorOutput{});
  ASSERT_TRUE(desk.operators.ack());
  EXPECT_EQ(desk.operators.ack()->result, A::kRefused);
  EXPECT_EQ(desk.operators.ack()->reasons, ConditionSet{Condition::kReelStale});
}

TEST(OperatorDialogue, EveryCommandLeavesALineInTheLog) {
  Desk desk;
  desk.ask(kAnna, {.request = Request::kTakeoff, .name = operatorName("anna")});
  ASSERT_TRUE(desk.operators.audit());
  EXPECT_STREQ(desk.operators.audit()->name.data(), "anna");
  EXPECT_STREQ(desk.operators.audit()->verb, "takeoff");
  EXPECT_EQ(desk.operators.audit()->result, A::kAccepted);
  desk.ask(kBert, {.service = Service::kTakeLease, .name = operatorName("bert")});
  ASSERT_TRUE(desk.operators.audit());
  EXPECT_STREQ(desk.operators.audit()->verb, "lease take");
  EXPECT_EQ(desk.operators.audit()->result, A::kNotHolder);
}

TEST(OperatorDialogue, OutOfModeIsToldApartFromRefused) {
  Desk desk;
  desk.take({.session = kAnna, .sequence = 1, .request = Request::kTakeoff});
  desk.operators.answer(desk.in.now, SupervisorOutput{});
  EXPECT_EQ(desk.operators.ack()->result, A::kOutOfMode);
  EXPECT_EQ(desk.operators.counts()[static_cast<std::size_t>(A::kOutOfMode)], 1);
}

TEST(OperatorDialogue, SetsANumberInItsRangeInStandbyOnly) {
  Desk desk;
  EXPECT_EQ(desk.set("core.guidance.takeoff_height_m", 1.25), A::kAccepted);
  EXPECT_EQ(desk.config.guidance.takeoff_height_m, 1.25);
  ASSERT_TRUE(desk.operators.parameter());
  EXPECT_EQ(desk.operators.parameter()->key.view(), "core.guidance.takeoff_height_m");
  EXPECT_EQ(desk.operators.parameter()->before, GuidanceConfig{}.takeoff_height_m);

  EXPECT_EQ(desk.set("core.guidance.takeoff_height_m", 99.0), A::kBadValue);
  EXPECT_EQ(desk.set("core.guidance.takeoff_height_m", std::nan("")), A::kBadValue);
  EXPECT_EQ(desk.set("core.guidance.no_such_key", 1.0), A::kBadValue);
  EXPECT_EQ(desk.set("core.control.composite.pole.radius_m", 1.0), A::kBadValue) << "not live";
  EXPECT_EQ(desk.set("core.overruns_in_a_row", 7.5), A::kBadValue) << "a whole number";
  EXPECT_EQ(desk.set("core.overruns_in_a_row", 7), A::kAccepted);
  EXPECT_EQ(desk.config.overruns_in_a_row, 7);
  for (const auto& mode : kModeNames) {
    if (mode.value == Mode::kStandby) continue;
    desk.mode = mode.value;
    EXPECT_EQ(desk.set("core.guidance.takeoff_height_m", 1.0), A::kLocked) << mode.name;
  }
  EXPECT_EQ(desk.config.guidance.takeoff_height_m, 1.25);
}

TEST(OperatorDialogue, FaultsForbidArmingUntilSomeoneHasLooked) {
  Desk desk;
  SupervisorOutput failsafe;
  failsafe.mode = Mode::kLand;
  failsafe.changed = true;
  failsafe.reasons = {Condition::kLinkLost};
  const auto latched = [&] {
    return desk.operators.conditions(desk.in.now, desk.mode).has(Condition::kFaultLatched);
  };
  desk.operators.answer(desk.in.now, failsafe);
  EXPECT_TRUE(latched());
  desk.mode = Mode::kLand;
  EXPECT_EQ(desk.ask(kAnna, {.service = Service::kClearFaults}), A::kLocked);
  EXPECT_TRUE(latched());
  desk.mode = Mode::kStandby;
  EXPECT_EQ(desk.ask(kAnna, {.service = Service::kClearFaults}), A::kAccepted);
  EXPECT_FALSE(latched());
  desk.operators.answer(desk.in.now, failsafe);
  EXPECT_EQ(desk.ask(kAnna, {.request = Request::kDisarm}), A::kAccepted);
  EXPECT_FALSE(latched());
}

TEST(OperatorDialogue, TheStationTakesANewNumberWithoutTheHeap) {
  const auto station = std::make_unique<Station>(CoreConfig{});
  StepInput in;
  std::int64_t sequence = 0;
  const auto set = [&](std::string_view key, double value) {
    in.now += milliseconds(10);
    in.command = OperatorCommand{.session = kAnna,
                                 .sequence = ++sequence,
                                 .service = Service::kSetParameter,
                                 .parameter = parameterHash(key),
                                 .value = value};
    return station->step(in).ack->result;
  };
  const testing::MallocGuard guard;
  EXPECT_EQ(set("core.supervisor.armed_timeout_s", 5.0), A::kAccepted);
  EXPECT_EQ(set("core.localizer.no_such_key", 1.0), A::kBadValue);
  EXPECT_EQ(set("core.limits.no_such_key", 1.0), A::kBadValue);
  if (testing::MallocGuard::available()) {
    EXPECT_EQ(guard.allocations(), 0);
  }
  EXPECT_EQ(station->lease().session, kAnna) << "the lease outlives the new core";
}

}  // namespace
}  // namespace tautline
