#include "planning_offline/search/least_risk_tree.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "planning_offline/search/cost_to_go.h"
#include "planning_offline/search/test/small_world.h"

namespace tautline::planning {
namespace {

using testing::emptyWorld;
using testing::Oracle;
using testing::randomWorld;
using testing::SmallWorld;
using testing::WorldKind;

constexpr double kTolerance = 1e-11;

std::vector<WorldKind> allKinds() {
  std::vector<WorldKind> kinds;
  for (const bool planar : {true, false}) {
    for (const auto connectivity :
         {Connectivity::kFaces, Connectivity::kEdges, Connectivity::kVertices}) {
      for (const auto law :
           {TurnLaw::kConstant, TurnLaw::kLinear, TurnLaw::kQuadratic, TurnLaw::kThreshold}) {
        for (const auto mode : {RiskMode::kPerState, RiskMode::kRate}) {
          kinds.push_back({connectivity, planar, law, mode});
        }
      }
    }
  }
  return kinds;
}

std::unique_ptr<LeastRiskTree> treeOf(const SmallWorld& world) {
  return leastRiskTreeReference(*world.lattice, *world.risk, world.start, Progress());
}

TEST(LeastRiskTreeReference, EqualsIterationOverAllWalks) {
  int compared = 0;
  for (const WorldKind& kind : allKinds()) {
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      const SmallWorld world = randomWorld(kind, seed);
      Oracle oracle(world);
      const std::vector<double> truth = oracle.walkOptimaByIteration();
      const auto tree = treeOf(world);
      ASSERT_TRUE(tree->complete());
      for (CellIndex cell = 0; cell < static_cast<CellIndex>(truth.size()); ++cell) {
        const double expected = truth[static_cast<std::size_t>(cell)];
        const std::vector<CellIndex> path = tree->pathTo(cell);
        if (std::isinf(expected)) {
          EXPECT_TRUE(std::isinf(tree->costTo(cell)));
          EXPECT_TRUE(path.empty());
          continue;
        }
        ASSERT_NEAR(tree->costTo(cell), expected, kTolerance) << "seed " << seed;
        ASSERT_FALSE(path.empty());
        EXPECT_EQ(path.back(), cell);
        EXPECT_NEAR(oracle.costOf(path), expected, kTolerance);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 5000);
}

TEST(CostToGo, IsWhatTheTreeOfEachStartHasBehindIt) {
  for (const WorldKind& kind : allKinds()) {
    for (std::uint32_t seed = 100; seed < 104; ++seed) {
      const SmallWorld world = randomWorld(kind, seed);
      const auto tree = treeOf(world);
      const double at_start = world.risk->startCost(world.start);
      if (std::isinf(at_start)) continue;
      for (std::size_t i = 0; i < world.map->shape.size(); ++i) {
        const auto goal = static_cast<CellIndex>(i);
        if (!world.isFree(goal)) continue;
        CostToGo to_go(*world.lattice, *world.risk, world.start, goal, {});
        const double cost = to_go.cost(world.start, kNoDirection);
        if (std::isinf(tree->costTo(goal))) {
          EXPECT_TRUE(std::isinf(cost));
        } else {
          EXPECT_NEAR(at_start + cost, tree->costTo(goal), kTolerance);
        }
      }
    }
  }
}

TEST(CostToGo, FollowsItsOwnSteps) {
  const SmallWorld world = randomWorld({.connectivity = Connectivity::kVertices}, 7);
  for (CellIndex goal = 0; goal < static_cast<CellIndex>(world.map->shape.size()); ++goal) {
    if (!world.isFree(goal)) continue;
    CostToGo to_go(*world.lattice, *world.risk, world.start, goal, {});
    if (std::isinf(to_go.cost(world.start, kNoDirection))) continue;
    CellIndex cell = world.start;
    Direction incoming = kNoDirection;
    double left = to_go.cost(cell, incoming);
    while (cell != goal) {
      const Direction d = to_go.next(cell, incoming);
      ASSERT_NE(d, kNoDirection);
      const CellIndex next = world.lattice->neighbour(cell, d);
      left -= world.risk->stepCost(cell, incoming, d, next);
      EXPECT_NEAR(left, to_go.cost(next, d), kTolerance);
      cell = next;
      incoming = d;
    }
  }
}

TEST(CostToGo, AddsWhatStepsCostBesides) {
  SmallWorld world = emptyWorld({4, 1, 1}, Connectivity::kFaces);
  world.build();
  CostToGo plain(*world.lattice, *world.risk, 0, 3, {});
  CostToGo dearer(*world.lattice, *world.risk, 0, 3,
                  {.extra = [](CellIndex to, Direction) { return 0.5 * to; }, .stop = {}});
  EXPECT_NEAR(dearer.cost(0, kNoDirection), plain.cost(0, kNoDirection) + 0.5 * (1 + 2 + 3),
              kTolerance);
}

TEST(CostToGo, IsALowerBoundOnceStopped) {
  const SmallWorld world = randomWorld({.connectivity = Connectivity::kFaces}, 11);
  for (CellIndex goal = 0; goal < static_cast<CellIndex>(world.map->shape.size()); ++goal) {
    if (!world.isFree(goal)) continue;
    CostToGo whole(*world.lattice, *world.risk, world.start, goal, {});
    for (int steps = 1; steps < 12; ++steps) {
      int left = steps;
      CostToGo part(*world.lattice, *world.risk, world.start, goal,
                    {.extra = {}, .stop = [&left] { return --left <= 0; }});
      EXPECT_LE(part.cost(world.start, kNoDirection),
                whole.cost(world.start, kNoDirection) + kTolerance);
    }
  }
}

TEST(LeastRiskTreeReference, IsTheSameEveryTimeWhereEverythingTies) {
  SmallWorld world = emptyWorld({5, 1, 5}, Connectivity::kEdges);
  world.start = 12;
  world.build();
  const auto one = treeOf(world);
  const auto two = treeOf(world);
  for (CellIndex cell = 0; cell < 25; ++cell) EXPECT_EQ(one->pathTo(cell), two->pathTo(cell));
}

TEST(LeastRiskTreeReference, PrefersTheShorterOfEqualCosts) {
  SmallWorld world = emptyWorld({6, 1, 6}, Connectivity::kVertices);
  world.params.action_length.per_metre = 0.0;  // nothing costs anything
  world.build();
  const auto tree = treeOf(world);
  EXPECT_EQ(tree->costTo(35), 0.0);
  EXPECT_EQ(tree->pathTo(35).size(), 6U);
}

TEST(LeastRiskTreeReference, TheStartIsAPathOfOneCell) {
  SmallWorld world = emptyWorld({1, 1, 1}, Connectivity::kFaces);
  world.build();
  const auto tree = treeOf(world);
  EXPECT_EQ(tree->pathTo(0), std::vector<CellIndex>{0});
  EXPECT_EQ(tree->costTo(0), 0.0);
}

TEST(LeastRiskTreeReference, AForbiddenStartLeadsNowhere) {
  SmallWorld world = emptyWorld({2, 1, 1}, Connectivity::kFaces);
  world.map->layers = {{"surface", {1.0, 0.0}}};
  world.params.surface.scale = 1.0;
  world.build();
  const auto tree = treeOf(world);
  EXPECT_TRUE(std::isinf(tree->costTo(0)));
  EXPECT_TRUE(tree->pathTo(1).empty());
}

TEST(LeastRiskTreeReference, ACancelledSearchSaysSo) {
  SmallWorld world = emptyWorld({30, 1, 30}, Connectivity::kEdges);
  world.build();
  Progress progress;
  progress.cancel();
  const auto tree = leastRiskTreeReference(*world.lattice, *world.risk, world.start, progress);
  EXPECT_FALSE(tree->complete());
  EXPECT_TRUE(tree->pathTo(899).empty());
}

}  // namespace
}  // namespace tautline::planning
