#include "planning_offline/planner/additive_cost.h"
#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/outcome.h"
#include "planning_offline/search/components.h"

namespace tautline::planning {
namespace {

class Additive final : public Planner {
 public:
  [[nodiscard]] PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                const Progress& progress) const override;
};

PlanResult Additive::plan(const PlanProblem& problem, const PlanOptions& options,
                          const Progress& progress) const {
  needGoalOrRewards(problem, options);
  Budget budget(options, progress);
  const AdditivePaths found = additivePaths(
      *problem.lattice,
      additiveCosts(*problem.lattice, *problem.risk, AdditiveWeights::kNormalized), problem.start,
      [&budget] { return budget.spent(0, "additive paths"); }, options.goal);
  // Its own optimum is no statement about risk: whatever it finds is a path, not a proven one.
  if (!options.goal) {
    const auto path = [&](CellIndex cell) { return found.pathTo(cell); };
    const auto cost = [&](CellIndex cell) {
      const std::vector<CellIndex> cells = found.pathTo(cell);
      return cells.empty() ? kInfiniteCost : problem.risk->evaluate(cells).cost;
    };
    return concludeAll(problem, options, {{cost, path}, false, budget.reason(), found.expanded},
                       progress);
  }
  PlanResult result = concludeGoal(problem, options,
                                   {.path = found.pathTo(*options.goal),
                                    .proven = false,
                                    .cut = budget.reason(),
                                    .expanded = found.expanded});
  result.risk_lower_bound.reset();
  if (result.status == PlanStatus::kFeasible) {
    result.status = PlanStatus::kOptimal;
    result.text = "least additive sum of normalized locale risks; its risk is what the model says";
  }
  return result;
}

}  // namespace

std::unique_ptr<Planner> makeAdditive() { return std::make_unique<Additive>(); }

}  // namespace tautline::planning
