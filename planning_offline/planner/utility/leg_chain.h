#pragma once

/// @file
/// Good paths on large maps with few rewards: one least-risk leg after the other, each to the
/// reward that then is worth most. Not real-time safe: offline only.

#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/utility/candidates.h"
#include "planning_offline/planner/utility/reward_problem.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {

/// `tree` is rooted at the start. Cells already visited are closed to later legs, so the paths are
/// simple. Goes on beyond the first leg that makes the path worse, for it may pay off later.
void chainLegs(RewardProblem& problem, const LeastRiskTree& tree, int threads,
               const Progress& progress, Candidates& found, Budget& budget);

}  // namespace tautline::planning
