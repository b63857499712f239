#pragma once

/// @file
/// How the planners of least risk end: from what a search found to a result with status, bound and
/// text. Not real-time safe: offline only.

#include <string>
#include <vector>

#include "planning_offline/planner/choose_goal.h"
#include "planning_offline/planner/planner.h"

namespace tautline::planning {

/// What a text about a missing path ends with: the limits of the tether that were met, by their
/// names in the parameters. Empty if none was, or if there is no way to the goal without them.
[[nodiscard]] std::string limitsClause(const PlanProblem& problem, const PlanOptions& options,
                                       const BrokenLimits& refused);

/// What a search for the least risk to options.goal found.
struct GoalSearch {
  std::vector<CellIndex> path;  ///< Empty: none.
  bool proven{true};            ///< The search's promise holds: the path has the least risk.
  double lower_bound{0.0};      ///< Cost −log(1 − risk) that no path is below.
  bool rounded{false};          ///< Proven to within lower_bound only: the search rounded costs.
  bool capped{false};           ///< Left out paths above options.risk_cap; others keep them.
  const char* cut{nullptr};     ///< What stopped it early; null: nothing.
  std::int64_t expanded{0};
  BrokenLimits refused{};  ///< Limits of the tether that it met.
};
/// A path above options.risk_cap is none. Without a path the text has the limitsClause().
[[nodiscard]] PlanResult concludeGoal(const PlanProblem& problem, const PlanOptions& options,
                                      const GoalSearch& found);

/// What a search for the best paths to all cells found.
struct AllSearch {
  PathsToAll paths;
  bool proven{true};  ///< The paths have the least risk.
  const char* cut{nullptr};
  std::int64_t expanded{0};
  BrokenLimits refused{};  ///< Limits of the tether that it met.
};
/// Chooses the end by options.objective. Stops choosing when cancelled.
[[nodiscard]] PlanResult concludeAll(const PlanProblem& problem, const PlanOptions& options,
                                     const AllSearch& found, const Progress& progress);

}  // namespace tautline::planning
