#include "common/loop_timer.h"

#include <gtest/gtest.h>

#include "common/clock.h"

namespace tautline {
namespace {

using std::chrono::milliseconds;

constexpr Duration kPeriod = milliseconds(10);
constexpr Time kStart{milliseconds(1000)};

TEST(TickGrid, GoesOnePeriodAtATimeWhenInTime) {
  TickGrid grid(kPeriod, kStart);
  for (int i = 1; i <= 5; ++i) {
    EXPECT_EQ(grid.advance(grid.next() + milliseconds(3)), 0);
    EXPECT_EQ(grid.next(), kStart + i * kPeriod);
  }
}

// For every way of being late: the next tick is on the grid, not in the past, not more than a
// period ahead, and the count of skipped periods closes the account.
TEST(TickGrid, StaysOnTheGridHoweverLate) {
  for (Duration late = Duration::zero(); late < milliseconds(55);
       late += std::chrono::microseconds(250)) {
    TickGrid grid(kPeriod, kStart);
    const Time now = kStart + late;
    const std::int64_t skipped = grid.advance(now);
    EXPECT_EQ((grid.next() - kStart) % kPeriod, Duration::zero());
    EXPECT_GE(grid.next(), now);
    EXPECT_LT(grid.next() - now, kPeriod + Duration(1));
    EXPECT_EQ(grid.next(), kStart + (skipped + 1) * kPeriod);
  }
}

TEST(TickGrid, EndingExactlyOnTheNextTickIsInTime) {
  TickGrid grid(kPeriod, kStart);
  EXPECT_EQ(grid.advance(kStart + kPeriod), 0);
  EXPECT_EQ(grid.advance(kStart + 2 * kPeriod + Duration(1)), 1);
}

TEST(SleepUntil, NeverWakesEarlyAndReturnsAtOnceForThePast) {
  for (int i = 0; i < 20; ++i) {
    const Time t = monotonicNow() + std::chrono::microseconds(500);
    sleepUntil(t);
    EXPECT_GE(monotonicNow(), t);
  }
  sleepUntil(monotonicNow() - milliseconds(100));
}

TEST(LoopStatistics, CountsSinceStartAndMeasuresTheWindow) {
  LoopStatistics statistics;
  statistics.record(milliseconds(1), milliseconds(2), 0);
  statistics.record(milliseconds(3), milliseconds(14), 1);
  statistics.record(milliseconds(2), milliseconds(25), 2);
  auto s = statistics.snapshot();
  EXPECT_EQ(s.cycles, 3);
  EXPECT_EQ(s.overruns, 2);
  EXPECT_EQ(s.skipped_periods, 3);
  EXPECT_EQ(s.missed_in_a_row, 3);
  EXPECT_DOUBLE_EQ(s.lateness_mean, 0.002);
  EXPECT_DOUBLE_EQ(s.lateness_max, 0.003);
  EXPECT_NEAR(s.work_mean, 41e-3 / 3, 1e-12);

  statistics.startWindow();
  statistics.record(milliseconds(1), milliseconds(1), 0);
  s = statistics.snapshot();
  EXPECT_EQ(s.cycles, 4);
  EXPECT_EQ(s.overruns, 2);
  EXPECT_EQ(s.missed_in_a_row, 0);
  EXPECT_DOUBLE_EQ(s.work_max, 0.001);
  EXPECT_DOUBLE_EQ(s.work_max_ever, 0.025);
}

}  // namespace
}  // namespace tautline
