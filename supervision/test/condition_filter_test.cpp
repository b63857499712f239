#include "supervision/condition_filter.h"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace tautline {
namespace {

using C = Condition;
using std::chrono::milliseconds;

TEST(ConditionFilter, CountsAfterTheGuardAndForgetsAfterTheRecovery) {
  for (const ConditionInfo& info : kConditionInfos) {
    ConditionFilter filter;
    Time now{std::chrono::seconds(100)};
    const auto run = [&](bool is, Duration for_how_long) {
      const ConditionSet raw = is ? ConditionSet{info.condition} : ConditionSet{};
      for (const Time end = now + for_how_long; now < end; now += milliseconds(10))
        if (filter.update(now, raw) != ConditionSet{}) return true;
      return false;
    };
    const Duration guard = fromSeconds(info.guard_s);
    EXPECT_FALSE(run(false, milliseconds(50))) << info.name;
    EXPECT_FALSE(run(true, guard)) << info.name << ": not before its guard time";
    EXPECT_TRUE(run(true, milliseconds(20))) << info.name;
    const Time gone = now;
    Time clear = now;
    while (filter.update(now, {}) != ConditionSet{}) clear = now += milliseconds(10);
    EXPECT_EQ(clear - gone, fromSeconds(info.recovery_s)) << info.name;
  }
}

TEST(ConditionFilter, AFlickeringFaultIsOneFault) {
  ConditionFilter filter;
  Time now{};
  ASSERT_GT(infoOf(C::kTetherSnagged).recovery_s, 0.1);
  int changes = 0;
  ConditionSet before;
  for (int i = 0; i < 1000; ++i, now += milliseconds(10)) {
    const ConditionSet set =
        filter.update(now, i % 7 == 0 ? ConditionSet{C::kTetherSnagged} : ConditionSet{});
    changes += set == before ? 0 : 1;
    before = set;
  }
  EXPECT_EQ(changes, 1);
}

// Against a second implementation that keeps the whole history.
TEST(ConditionFilter, AgreesWithItsDefinitionOnRandomHistories) {
  std::mt19937 random(1);
  for (int run = 0; run < 20; ++run) {
    ConditionFilter filter;
    std::vector<ConditionSet> history;
    std::array<bool, kConditionCount> counts{};
    ConditionSet raw;
    for (int cycle = 0; cycle < 2000; ++cycle) {
      for (int flips = static_cast<int>(random() % 2U); flips > 0; --flips) {
        const auto c = static_cast<C>(random() % kConditionCount);
        raw.set(c, !raw.has(c));
      }
      history.push_back(raw);
      const ConditionSet out = filter.update(Time{milliseconds(10) * cycle}, raw);
      for (std::size_t i = 0; i < kConditionCount; ++i) {
        const ConditionInfo& info = kConditionInfos[i];
        const double patience = counts[i] ? info.recovery_s : info.guard_s;
        const int cycles = static_cast<int>(patience * 100.0 + 0.5);
        bool lasted = static_cast<int>(history.size()) > cycles;
        for (int back = 0; lasted && back <= cycles; ++back)
          lasted = history[history.size() - 1 - static_cast<std::size_t>(back)].has(
                       info.condition) != counts[i];
        if (lasted) counts[i] = !counts[i];
        ASSERT_EQ(out.has(info.condition), counts[i]) << info.name << " in cycle " << cycle;
      }
    }
  }
}

TEST(ConditionInfos, HaveNamesTextsAndRemedies) {
  for (const ConditionInfo& info : kConditionInfos) {
    EXPECT_STRNE(info.name, "");
    EXPECT_STRNE(info.text, "") << info.name;
    if (info.kind != ConditionKind::kFact) {
      EXPECT_STRNE(info.remedy, "") << info.name;
    }
    for (const ConditionInfo& other : kConditionInfos)
      if (&other != &info) {
        EXPECT_STRNE(info.name, other.name);
      }
  }
}

TEST(ConditionSet, DescribesInOrder) {
  EXPECT_EQ(describe(ConditionSet{C::kLinkLost, C::kReelStale}), "ENCODER_STALE LINK_VEHICLE");
  EXPECT_EQ(describe(ConditionSet{}), "");
}

}  // namespace
}  // namespace tautline
