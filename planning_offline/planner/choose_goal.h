#pragma once

/// @file
/// The lower stage of the dissertation's two-stage planner (Algorithm "Lower Stage Maximum Reward
/// Planner"): of the best paths to all cells, the one of the greatest utility. Not real-time safe:
/// offline only.

#include <functional>
#include <optional>
#include <vector>

#include "planning_offline/planner/planner.h"

namespace tautline::planning {

/// What a search found: for each cell the cost −log(1 − risk) of its best path (infinite if there
/// is none), the start's own included, and that path, start first.
struct PathsToAll {
  std::function<double(CellIndex)> cost;
  std::function<std::vector<CellIndex>(CellIndex)> path;
};

struct GoalChoice {
  CellIndex goal{kNoCell};
  std::vector<CellIndex> path;
  double utility{0.0};
  const char* cut{nullptr};  ///< What stopped the choosing early; null: nothing.
};

/// The cell whose best path has the greatest utility by options.objective among those within
/// options.risk_cap. Staying at the start is one of them. Ties: less risk, then ends with a reward,
/// then the lower cell. Empty if no path is within the cap. Returns the best so far when cancelled
/// or after options.time_limit.
[[nodiscard]] std::optional<GoalChoice> chooseGoal(const PlanProblem& problem,
                                                   const PlanOptions& options,
                                                   const PathsToAll& paths,
                                                   const Progress& progress);

/// For planners that need something to choose an end by. Throws InputError if there is neither a
/// goal nor a reward.
void needGoalOrRewards(const PlanProblem& problem, const PlanOptions& options);

}  // namespace tautline::planning
