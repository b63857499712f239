#include "supervision/fault_log.h"

#include <gtest/gtest.h>

namespace tautline {
namespace {

using C = Condition;
using std::chrono::seconds;

SupervisorOutput changed(Mode mode, ConditionSet reasons) {
  SupervisorOutput out;
  out.mode = mode;
  out.changed = true;
  out.reasons = reasons;
  return out;
}

TEST(FaultLog, KeepsEveryConditionBehindAFailsafe) {
  FaultLog log;
  log.update(Time{seconds(3)}, changed(Mode::kFailsafe, {C::kReelStale, C::kOscillation}));
  log.update(Time{seconds(9)}, changed(Mode::kLand, {C::kLinkLost}));
  ASSERT_EQ(log.count(), 3U);
  EXPECT_EQ(log[0].condition, C::kReelStale);
  EXPECT_EQ(log[1].condition, C::kOscillation);
  EXPECT_EQ(log[2].condition, C::kLinkLost);
  EXPECT_EQ(log[2].time, Time{seconds(9)});
  EXPECT_EQ(log[2].mode, Mode::kLand);
  EXPECT_TRUE(log.latched());
}

TEST(FaultLog, WhatIsPartOfAFlightIsNoFault) {
  FaultLog log;
  log.update(Time{}, changed(Mode::kHold, {C::kMissionDone}));
  log.update(Time{}, changed(Mode::kStandby, {C::kTouchdown}));
  log.update(Time{}, changed(Mode::kLand, {}));  // asked for
  SupervisorOutput staying = changed(Mode::kFailsafe, {C::kReelStale});
  staying.changed = false;
  log.update(Time{}, staying);
  EXPECT_EQ(log.count(), 0U);
  EXPECT_FALSE(log.latched());
}

TEST(FaultLog, KeepsTheLastOnesOldestFirst) {
  FaultLog log;
  for (int i = 0; i < 40; ++i) {
    log.update(Time{seconds(i)}, changed(Mode::kFailsafe, {C::kReelStale}));
    ASSERT_LE(log.count(), FaultLog::kCapacity);
  }
  for (std::size_t i = 0; i < FaultLog::kCapacity; ++i)
    EXPECT_EQ(log[i].time, Time{seconds(24 + static_cast<int>(i))});
}

TEST(FaultLog, ALookUnlatchesAndTheListStays) {
  FaultLog log;
  log.update(Time{}, changed(Mode::kFailsafe, {C::kReelStale}));
  log.acknowledge();
  EXPECT_FALSE(log.latched());
  EXPECT_EQ(log.count(), 1U);
  log.update(Time{}, changed(Mode::kLand, {C::kLinkLost}));
  EXPECT_TRUE(log.latched());
}

}  // namespace
}  // namespace tautline
