/// All planners of least risk against everything there is, on thousands of small random maps.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "planning_offline/planner/test/planner_test_kit.h"

namespace tautline::planning {
namespace {

using testing::kindNumber;
using testing::kKinds;
using testing::Oracle;
using testing::planTo;
using testing::randomWorld;
using testing::SmallWorld;
using testing::Truth;
using testing::truthOf;
using testing::WorldKind;

constexpr double kTolerance = 1e-10;

/// Which traverse elements and limits the maps have.
struct Traversed {
  bool tether{false};
  bool mud{false};
  bool battery{false};
  bool sharp{false};
};

/// Calls f(world, oracle, truth, goal) for the goals of `seeds` maps of each kind.
template <class F>
int forGoals(const Traversed& with, std::uint32_t seeds, F f) {
  int maps = 0;
  for (int k = 0; k < kKinds; ++k) {
    WorldKind kind = kindNumber(k);
    kind.tether = with.tether;
    kind.mud = with.mud;
    kind.battery = with.battery;
    kind.sharp = with.sharp;
    for (std::uint32_t seed = 0; seed < seeds; ++seed) {
      const SmallWorld world = randomWorld(kind, 1000U * static_cast<std::uint32_t>(k) + seed);
      const Truth truth = truthOf(world);
      if (!truth.known) continue;
      ++maps;
      Oracle oracle(world);
      for (std::size_t i = 0; i < truth.simple.size(); ++i) {
        const auto goal = static_cast<CellIndex>(i);
        if (!world.isFree(goal)) continue;
        SCOPED_TRACE(::testing::Message() << "kind " << k << " seed " << seed << " goal " << goal);
        f(world, oracle, truth, goal);
        if (::testing::Test::HasFatalFailure()) return maps;
      }
    }
  }
  return maps;
}

double at(const std::vector<double>& values, CellIndex i) {
  return values[static_cast<std::size_t>(i)];
}

/// The result is a path to the goal that costs what it says.
void expectSound(const PlanResult& result, const SmallWorld& world, Oracle& oracle,
                 CellIndex goal) {
  ASSERT_FALSE(result.path.empty()) << result.text;
  EXPECT_EQ(result.path.front(), world.start);
  EXPECT_EQ(result.path.back(), goal);
  EXPECT_NEAR(result.report.cost, oracle.costOf(result.path), kTolerance);
  ASSERT_TRUE(result.risk_lower_bound.has_value());
  EXPECT_LE(*result.risk_lower_bound, result.report.risk + kTolerance);
}

void expectUnreachable(const PlanResult& result) {
  EXPECT_EQ(result.status, PlanStatus::kUnreachable);
  EXPECT_TRUE(result.path.empty());
}

/// `tether` and `exact` on one goal.
void compareExact(const SmallWorld& world, Oracle& oracle, const Truth& truth, CellIndex goal) {
  const PlanResult exact = planTo(*makeExact(), world, goal);
  if (std::isinf(at(truth.simple, goal))) {
    expectUnreachable(exact);
    // A walk may still lead there: it can fly a loop to get rid of a contact. If none does, only
    // limits end the search: there is no end to the ways a string can be wound round obstacles.
    PlanOptions options;
    options.label_limit = 3000;
    const PlanResult tether = planTo(*makeTether(), world, goal, options);
    if (tether) {
      ASSERT_NO_FATAL_FAILURE(expectSound(tether, world, oracle, goal));
      EXPECT_FALSE(tether.simple);
    }
    return;
  }
  const PlanResult tether = planTo(*makeTether(), world, goal);
  ASSERT_NO_FATAL_FAILURE(expectSound(exact, world, oracle, goal));
  EXPECT_EQ(exact.status, PlanStatus::kOptimal);
  EXPECT_TRUE(exact.simple);
  ASSERT_NEAR(exact.report.cost, at(truth.simple, goal), kTolerance);
  ASSERT_NO_FATAL_FAILURE(expectSound(tether, world, oracle, goal));
  EXPECT_EQ(tether.status, PlanStatus::kOptimal);
  // No walk of a bounded number of steps is better; and if the planner's own is that short, it is
  // one of them.
  ASSERT_LE(tether.report.cost, at(truth.walk, goal) + kTolerance);
  if (static_cast<int>(tether.path.size()) <= truth.steps + 1) {
    ASSERT_NEAR(tether.report.cost, at(truth.walk, goal), kTolerance);
  }
}

TEST(BruteForce, LocaleAndActionElementsHaveAllPlannersOptimal) {
  const int maps = forGoals(
      {}, 12, [](const SmallWorld& world, Oracle& oracle, const Truth& truth, CellIndex goal) {
        compareExact(world, oracle, truth, goal);
        const PlanResult tether = planTo(*makeTether(), world, goal);
        for (const auto& planner : {makeDirectional(), makeLookback()}) {
          const PlanResult result = planTo(*planner, world, goal);
          EXPECT_EQ(result.status, tether.status);
          ASSERT_NEAR(result.report.cost, tether.report.cost, kTolerance);
          if (!result) continue;
          ASSERT_NO_FATAL_FAILURE(expectSound(result, world, oracle, goal));
        }
      });
  EXPECT_GT(maps, 400);
}

TEST(BruteForce, TheTetherIsExact) { EXPECT_GT(forGoals({.tether = true}, 12, compareExact), 400); }

/// The marks must make a difference, or the maps would tell nothing.
TEST(BruteForce, ForbiddenContactsAreExact) {
  int forbidden = 0;
  const int maps =
      forGoals({.tether = true, .sharp = true}, 12,
               [&](const SmallWorld& world, Oracle& oracle, const Truth& truth, CellIndex goal) {
                 compareExact(world, oracle, truth, goal);
                 if (!std::isinf(at(truth.simple, goal))) return;
                 const SmallWorld blunt = testing::withoutMarks(world);
                 forbidden += planTo(*makeExact(), blunt, goal) ? 1 : 0;
               });
  EXPECT_GT(maps, 400);
  EXPECT_GT(forbidden, 20);
}

TEST(BruteForce, MudIsExact) { EXPECT_GT(forGoals({.mud = true}, 12, compareExact), 400); }

TEST(BruteForce, TheBatteryIsExact) {
  EXPECT_GT(forGoals({.battery = true}, 12, compareExact), 400);
}

TEST(BruteForce, AllTraverseElementsAtOnceAreExact) {
  EXPECT_GT(forGoals({.tether = true, .mud = true, .battery = true}, 8, compareExact), 250);
}

struct Comparison {
  int goals{0};
  int directional_worse{0};
  int longer_lookback_worse{0};
};

/// The published planners on traverse elements: never better than the optimum, and their lower
/// bound never above it.
void comparePublished(const SmallWorld& world, CellIndex goal, Comparison& seen) {
  Oracle oracle(world);
  const PlanResult best = planTo(*makeTether(), world, goal);
  const PlanResult directional = planTo(*makeDirectional(), world, goal);
  if (!best || !directional) return;
  double last = directional.report.cost;
  for (const int n : {2, 3, 4}) {
    PlanOptions options;
    options.lookback = n;
    const PlanResult result = planTo(*makeLookback(), world, goal, options);
    ASSERT_NO_FATAL_FAILURE(expectSound(result, world, oracle, goal));
    EXPECT_EQ(result.status, PlanStatus::kFeasible);
    ASSERT_GE(result.report.cost, best.report.cost - kTolerance);
    EXPECT_LE(*result.risk_lower_bound, best.report.risk + kTolerance);
    if (n == 2) {
      EXPECT_EQ(result.path, directional.path);
    }
    if (result.report.cost > last + kTolerance) ++seen.longer_lookback_worse;
    last = result.report.cost;
  }
  ++seen.goals;
  if (directional.report.cost > best.report.cost + kTolerance) ++seen.directional_worse;
}

TEST(BruteForce, DirectionalAndLookbackAreFeasibleWithAValidBound) {
  Comparison seen;
  for (const auto connectivity : {Connectivity::kFaces, Connectivity::kEdges}) {
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
      const SmallWorld world = randomWorld({.connectivity = connectivity,
                                            .law = TurnLaw::kConstant,
                                            .tether = seed % 3 == 0,
                                            .mud = true,
                                            .battery = seed % 2 == 0,
                                            .side = 6},
                                           seed);
      for (std::size_t i = 0; i < world.map->shape.size(); ++i) {
        const auto goal = static_cast<CellIndex>(i);
        if (!world.isFree(goal)) continue;
        SCOPED_TRACE(::testing::Message() << "seed " << seed << " goal " << goal);
        ASSERT_NO_FATAL_FAILURE(comparePublished(world, goal, seen));
      }
    }
  }
  RecordProperty("goals", seen.goals);
  RecordProperty("directional_worse_than_tether", seen.directional_worse);
  RecordProperty("longer_lookback_worse", seen.longer_lookback_worse);
  EXPECT_GT(seen.goals, 1000);
  EXPECT_GT(seen.directional_worse, 0);  // else the maps would tell nothing
}

}  // namespace
}  // namespace tautline::planning
