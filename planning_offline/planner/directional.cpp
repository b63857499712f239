#include "planning_offline/planner/lookback.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/outcome.h"
#include "planning_offline/planner/traverse.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {
namespace {

class Directional final : public Planner {
 public:
  [[nodiscard]] PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                const Progress& progress) const override;
};

PlanResult Directional::plan(const PlanProblem& problem, const PlanOptions& options,
                             const Progress& progress) const {
  if (Traverse(*problem.risk).active()) {
    return planLookback(problem, options, 2, progress);
  }
  needGoalOrRewards(problem, options);
  const auto tree =
      leastRiskTree(*problem.lattice, *problem.risk, problem.start, options.threads, progress);
  const char* cut = tree->complete() ? nullptr : "cancelled";
  const auto expanded = static_cast<std::int64_t>(tree->expanded());
  if (!options.goal) {
    const PathsToAll paths{[&](CellIndex cell) { return tree->costTo(cell); },
                           [&](CellIndex cell) { return tree->pathTo(cell); }};
    return concludeAll(problem, options, {paths, true, cut, expanded}, progress);
  }
  return concludeGoal(
      problem, options,
      {.path = tree->pathTo(*options.goal),
       .lower_bound = cut != nullptr ? 0.0 : tree->costTo(*options.goal) - tree->costError(),
       .rounded = tree->costError() > 0.0,
       .cut = cut,
       .expanded = expanded});
}

}  // namespace

std::unique_ptr<Planner> makeDirectional() { return std::make_unique<Directional>(); }

}  // namespace tautline::planning
