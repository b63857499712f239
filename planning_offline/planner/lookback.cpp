#include "planning_offline/planner/lookback.h"

#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/label_search.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/outcome.h"
#include "planning_offline/planner/traverse.h"

namespace tautline::planning {
namespace {

class Lookback final : public Planner {
 public:
  [[nodiscard]] PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                const Progress& progress) const override {
    return planLookback(problem, options, options.lookback, progress);
  }
};

}  // namespace

PlanResult planLookback(const PlanProblem& problem, const PlanOptions& options, int n,
                        const Progress& progress) {
  constexpr const char* kWhat = "paths with look-back";
  needGoalOrRewards(problem, options);
  const Lattice& lattice = *problem.lattice;
  Budget budget(options, progress);
  Traverse traverse(*problem.risk);
  LabelSearch search(lattice, traverse, problem.start,
                     {.lookback = n, .goal = options.goal.value_or(kNoCell)});
  search.run(budget, kWhat);
  const bool proven = !traverse.active();
  if (!options.goal) {
    const PathsToAll paths{[&](CellIndex cell) { return search.costTo(cell); },
                           [&](CellIndex cell) { return search.pathTo(cell); }};
    return concludeAll(problem, options, {paths, proven, budget.reason(), search.expanded()},
                       progress);
  }
  GoalSearch found{.path = search.pathTo(*options.goal),
                   .proven = proven,
                   .cut = budget.reason(),
                   .expanded = search.expanded()};
  if (found.cut != nullptr && proven) {
    found.lower_bound = search.openCost();
  } else if (found.cut == nullptr && !proven) {
    CostToGo to_go(lattice, *problem.risk, problem.start, *options.goal,
                   {.extra = [&](CellIndex v, Direction d) { return traverse.tetherBound(v, d); },
                    .stop = [&] { return budget.spent(0, kWhat); }});
    found.lower_bound = traverse.startCost(problem.start) + to_go.cost(problem.start, kNoDirection);
  }
  return concludeGoal(problem, options, found);
}

std::unique_ptr<Planner> makeLookback() { return std::make_unique<Lookback>(); }

}  // namespace tautline::planning
