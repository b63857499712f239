#pragma once

/// @file
/// The published search with the look-back as a parameter. Not real-time safe: offline only.

#include "planning_offline/planner/planner.h"

namespace tautline::planning {

/// States remember the last n − 1 incoming directions, n = 2 … 4, and carry what traverse elements
/// need of their best path. To options.goal, or to the best end by options.objective. Of least risk
/// if no element looks back further than n; else feasible, with a lower bound.
[[nodiscard]] PlanResult planLookback(const PlanProblem& problem, const PlanOptions& options, int n,
                                      const Progress& progress);

}  // namespace tautline::planning
