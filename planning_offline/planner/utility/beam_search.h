#pragma once

/// @file
/// Good paths quickly, without a promise: all simple paths of the same number of states at a time,
/// the best of them kept. Not real-time safe: offline only.

#include <cstddef>

#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/utility/candidates.h"
#include "planning_offline/planner/utility/reward_problem.h"

namespace tautline::planning {

/// Keeps `width` paths a level, ranked by R − μ C with μ = u e^{−C} of the best path found so far
/// (Dinkelbach's parameter, docs/utility.md), or by expected reward and what surviving is worth.
/// Repeats with the new μ as long as that finds better ones.
void beamSearch(RewardProblem& problem, std::size_t width, Candidates& found, Budget& budget);

}  // namespace tautline::planning
