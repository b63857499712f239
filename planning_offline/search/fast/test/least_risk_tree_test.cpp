// The fast tree on real risk models, against the reference in double.

#include "planning_offline/search/least_risk_tree.h"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "planning_offline/search/test/small_world.h"

namespace tautline::planning {
namespace {

using testing::emptyWorld;
using testing::randomWorld;
using testing::SmallWorld;
using testing::WorldKind;

// Largest share of a cost that whole units may take off it: unit / cheapest step, times roundings.
constexpr double kShare = 0.01;

void expectNear(const SmallWorld& world, const LeastRiskTree& fast, const LeastRiskTree& exact) {
  ASSERT_TRUE(fast.complete());
  for (CellIndex cell = 0; cell < static_cast<CellIndex>(world.map->shape.size()); ++cell) {
    if (!world.isFree(cell)) continue;
    const double cost = exact.costTo(cell);
    if (std::isinf(cost)) {
      ASSERT_TRUE(std::isinf(fast.costTo(cell))) << cell;
      ASSERT_TRUE(fast.pathTo(cell).empty());
      continue;
    }
    ASSERT_LE(fast.costTo(cell), cost + fast.costError()) << cell;
    ASSERT_GE(fast.costTo(cell), cost * (1.0 - kShare) - 1e-3) << cell;
    const double walked = world.risk->evaluate(fast.pathTo(cell)).cost;
    ASSERT_GE(walked, cost - 1e-9) << cell;
    ASSERT_LE(walked, cost * (1.0 + kShare) + 1e-3) << cell;
  }
}

TEST(LeastRiskTreeFast, IsNearTheExactOneOnSmallWorlds) {
  std::uint32_t seed = 0;
  for (const auto connectivity :
       {Connectivity::kFaces, Connectivity::kEdges, Connectivity::kVertices}) {
    for (const bool planar : {true, false}) {
      for (const auto law : {TurnLaw::kConstant, TurnLaw::kLinear, TurnLaw::kThreshold}) {
        for (const auto mode : {RiskMode::kPerState, RiskMode::kRate}) {
          for (int repeat = 0; repeat < 8; ++repeat) {
            SCOPED_TRACE(seed);
            const SmallWorld world =
                randomWorld({connectivity, planar, law, mode, false, false, false}, ++seed);
            const auto fast =
                leastRiskTreeFast(*world.lattice, *world.risk, world.start, 1, Progress());
            const auto exact =
                leastRiskTreeReference(*world.lattice, *world.risk, world.start, Progress());
            expectNear(world, *fast, *exact);
            if (HasFatalFailure()) return;
          }
        }
      }
    }
  }
}

TEST(LeastRiskTreeFast, ThreadsDoNotMatter) {
  SmallWorld world = emptyWorld({12, 9, 10}, Connectivity::kVertices);
  world.params.turn = {.law = TurnLaw::kLinear, .risk = 0.05};
  for (std::size_t i = 0; i < world.map->cells.size(); i += 7)
    world.map->cells[i] = CellState::kOccupied;
  world.start = 1;
  world.build();
  const auto one = leastRiskTreeFast(*world.lattice, *world.risk, world.start, 1, Progress());
  const auto all = leastRiskTreeFast(*world.lattice, *world.risk, world.start, 0, Progress());
  for (CellIndex cell = 0; cell < 1080; ++cell) {
    if (!world.isFree(cell)) continue;
    EXPECT_EQ(one->costTo(cell), all->costTo(cell));
    EXPECT_EQ(one->pathTo(cell), all->pathTo(cell));
  }
}

TEST(LeastRiskTreeFast, AForbiddenStartReachesNothing) {
  SmallWorld world = emptyWorld({3, 1, 3}, Connectivity::kVertices);
  world.map->layers = {{"surface", std::vector<double>(9, 0.0)}};
  world.map->layers[0].values[4] = 1.0;
  world.params.surface.scale = 1.0;
  world.build();
  const auto tree = leastRiskTreeFast(*world.lattice, *world.risk, 4, 1, Progress());
  for (CellIndex cell = 0; cell < 9; ++cell) EXPECT_TRUE(std::isinf(tree->costTo(cell))) << cell;
}

TEST(LeastRiskTree, IsExactOnSmallMapsAndFastOnLargeOnes) {
  SmallWorld small = emptyWorld({10, 10, 10}, Connectivity::kVertices);
  small.build();
  EXPECT_EQ(leastRiskTree(*small.lattice, *small.risk, 0, 1, Progress())->costError(), 0.0);

  SmallWorld large = emptyWorld({24, 24, 24}, Connectivity::kVertices);
  large.params.turn.risk = 0.05;
  large.build();
  const auto tree = leastRiskTree(*large.lattice, *large.risk, 0, 1, Progress());
  EXPECT_GT(tree->costError(), 0.0);
  const auto exact = leastRiskTreeReference(*large.lattice, *large.risk, 0, Progress());
  expectNear(large, *tree, *exact);

  // A turn of certain failure has no place in whole units: the reference does it.
  large.params.cap = 1.0;
  large.params.turn = {.law = TurnLaw::kThreshold, .risk = 0.1, .sharp_factor = 1000.0};
  large.build();
  const auto fallen_back = leastRiskTree(*large.lattice, *large.risk, 0, 1, Progress());
  EXPECT_EQ(fallen_back->costError(), 0.0);
  EXPECT_TRUE(fallen_back->complete());
}

}  // namespace
}  // namespace tautline::planning
