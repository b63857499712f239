#pragma once

/// @file
/// Small random maps with rewards for the tests of the utility planners, and the answers by looking
/// at every simple path.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "planning_offline/planner/planner.h"
#include "planning_offline/search/test/small_world.h"

namespace tautline::planning::testing {

struct RewardWorld {
  SmallWorld world;
  std::vector<double> reward;

  [[nodiscard]] PlanProblem problem() const {
    return {world.lattice.get(), world.risk.get(), reward, world.start};
  }
};

/// Rewards in a random part of the cells; in one at least.
[[nodiscard]] RewardWorld randomRewardWorld(const WorldKind& kind, std::uint32_t seed);

struct SimplePath {
  std::vector<CellIndex> cells;
  double cost{0.0};
  double reward{0.0};
  double expected{0.0};  ///< Σ reward_i Π_{j<=i} (1 − r_j)

  [[nodiscard]] double risk() const { return 1.0 - std::exp(-cost); }
  [[nodiscard]] double ratio() const { return reward > 0.0 ? reward / risk() : 0.0; }
};

/// Calls `visit` for every simple path from the start that is no certain failure, staying included.
/// False, and perhaps not for all, if there are more than `paths_max`.
[[nodiscard]] bool forAllSimplePaths(const RewardWorld& world, int paths_max,
                                     const std::function<void(const SimplePath&)>& visit);

}  // namespace tautline::planning::testing
