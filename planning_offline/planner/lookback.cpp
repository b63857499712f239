#include "planning_offline/planner/lookback.h"

#include <algorithm>
#include <optional>

#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/label_search.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/outcome.h"
#include "planning_offline/planner/traverse.h"
#include "planning_offline/search/cost_to_go.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {
namespace {

class Lookback final : public Planner {
 public:
  [[nodiscard]] PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                const Progress& progress) const override {
    return planLookback(problem, options, options.lookback, progress);
  }
};

/// Components above which look-back with traverse elements is led to the goal.
constexpr std::size_t kLargeComponents = 300'000;

/// The best path by locale and action elements alone, which is soon found: better than none when
/// the search was stopped.
void takePlainPath(const PlanProblem& problem, const PlanOptions& options, GoalSearch& found) {
  const auto tree =
      leastRiskTree(*problem.lattice, *problem.risk, problem.start, options.threads, Progress());
  found.path = tree->pathTo(*options.goal);
  found.lower_bound = std::max(found.lower_bound, tree->costTo(*options.goal) - tree->costError());
}

}  // namespace

PlanResult planLookback(const PlanProblem& problem, const PlanOptions& options, int n,
                        const Progress& progress) {
  constexpr const char* kWhat = "paths with look-back";
  needGoalOrRewards(problem, options);
  const Lattice& lattice = *problem.lattice;
  Budget budget(options, progress);
  Traverse traverse(*problem.risk);
  const bool proven = !traverse.active();
  std::optional<CostToGo> to_go;
  if (options.goal && !proven) {
    to_go.emplace(
        lattice, *problem.risk, problem.start, *options.goal,
        CostToGo::Hooks{[&](CellIndex v, Direction d) { return traverse.tetherBound(v, d); },
                        [&] { return budget.spent(0, kWhat); }});
  }
  // What a component carries depends on the order in which labels come up, so only large maps,
  // which the published order does not finish, are searched towards the goal.
  const bool led = to_go && lattice.freeCount() * lattice.directions().size() > kLargeComponents;
  LabelSearch search(
      lattice, traverse, problem.start,
      {.lookback = n, .goal = options.goal.value_or(kNoCell), .to_go = led ? &*to_go : nullptr});
  search.run(budget, kWhat);
  if (!options.goal) {
    const PathsToAll paths{[&](CellIndex cell) { return search.costTo(cell); },
                           [&](CellIndex cell) { return search.pathTo(cell); }};
    return concludeAll(problem, options,
                       {paths, proven, budget.reason(), search.expanded(), traverse.refused()},
                       progress);
  }
  GoalSearch found{.path = search.pathTo(*options.goal),
                   .proven = proven,
                   .cut = budget.reason(),
                   .expanded = search.expanded()};
  if (found.cut != nullptr && proven) {
    found.lower_bound = search.openCost();
  } else if (found.cut == nullptr && !proven) {
    found.lower_bound =
        traverse.startCost(problem.start) + to_go->cost(problem.start, kNoDirection);
  }
  if (found.cut != nullptr && found.path.empty()) takePlainPath(problem, options, found);
  found.refused = traverse.refused();
  return concludeGoal(problem, options, found);
}

std::unique_ptr<Planner> makeLookback() { return std::make_unique<Lookback>(); }

}  // namespace tautline::planning
