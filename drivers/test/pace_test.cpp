#include "drivers/pace.h"

#include <random>

#include <gtest/gtest.h>

namespace tautline {
namespace {

using namespace std::chrono_literals;

// Times it was done in `length` of a loop with this period and up to `jitter` of lateness a cycle.
int count(Duration period, Duration interval, Duration jitter, Duration length) {
  std::mt19937 random(1);
  Pace pace;
  int done = 0;
  for (Time tick{}; tick < Time{} + length; tick += period) {
    const Time now =
        tick +
        Duration(jitter.count() > 0 ? random() % static_cast<std::uint64_t>(jitter.count()) : 0);
    if (!pace.due(now)) continue;
    pace.done(now, interval);
    ++done;
  }
  return done;
}

TEST(Pace, MeanRateIsRightWhateverTheLoopsPeriodAndJitter) {
  for (const Duration period : {Duration(1ms), Duration(10ms), Duration(33ms), Duration(7ms)}) {
    for (const Duration jitter : {Duration(0), Duration(500us), period / 2}) {
      EXPECT_NEAR(count(period, 50ms, jitter, 100s), 2000, 1)
          << period.count() << " " << jitter.count();
    }
  }
}

TEST(Pace, IsAtMostOnceACycle) { EXPECT_EQ(count(100ms, 50ms, Duration(0), 10s), 100); }

TEST(Pace, AJitteringTickDoesNotMissItsTurn) {
  Pace pace;
  pace.done(Time{} + 300us, 50ms);
  EXPECT_FALSE(pace.due(Time{} + 40ms));
  EXPECT_TRUE(pace.due(Time{} + 50ms));
}

TEST(Pace, DoneEarlyOrLongAfterStartsANewGrid) {
  Pace pace;
  pace.done(Time{}, 50ms);
  pace.done(Time{} + 20ms, 50ms);
  EXPECT_FALSE(pace.due(Time{} + 50ms));
  EXPECT_TRUE(pace.due(Time{} + 70ms));
  pace.done(Time{} + 500ms, 50ms);  // no burst to catch up
  EXPECT_FALSE(pace.due(Time{} + 510ms));
  pace.reset();
  EXPECT_TRUE(pace.due(Time{} + 510ms));
}

}  // namespace
}  // namespace tautline
