#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/label_search.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/planner/outcome.h"
#include "planning_offline/planner/traverse.h"

namespace tautline::planning {
namespace {

constexpr const char* kWhat = "paths with the tether";

/// Room for rounding: a cost that is summed in another order must not fall out of a bound.
constexpr double kSlack = 1.0 + 1e-12;

class Tether final : public Planner {
 public:
  [[nodiscard]] PlanResult plan(const PlanProblem& problem, const PlanOptions& options,
                                const Progress& progress) const override;
};

/// One plan to a goal: what its stages share.
class GoalPlan {
 public:
  GoalPlan(const PlanProblem& problem, const PlanOptions& options, const Progress& progress)
      : problem_(problem),
        goal_(*options.goal),
        budget_(options, progress),
        traverse_(*problem.risk),
        to_go_(*problem.lattice, *problem.risk, problem.start, goal_,
               {.extra = [this](CellIndex v, Direction d) { return traverse_.tetherBound(v, d); },
                .stop = [this] { return budget_.spent(0, kWhat); }}) {}

  [[nodiscard]] GoalSearch run();

 private:
  /// Goes on with a path as if there were no tether, and keeps it if it is the best so far.
  void complete(std::vector<CellIndex> path);
  void keep(std::vector<CellIndex> path, double cost);
  [[nodiscard]] double costOf(const std::vector<CellIndex>& path);
  [[nodiscard]] LabelSearch searchFor(bool stacks) {
    return LabelSearch(*problem_.lattice, traverse_, problem_.start,
                       {.lookback = 2,
                        .stacks = stacks,
                        .goal = goal_,
                        .to_go = &to_go_,
                        .cost_max = best_cost_ * kSlack});
  }

  const PlanProblem& problem_;
  CellIndex goal_;
  Budget budget_;
  Traverse traverse_;
  CostToGo to_go_;
  std::vector<CellIndex> best_;
  double best_cost_{kInfiniteCost};
};

GoalSearch GoalPlan::run() {
  GoalSearch found;
  found.lower_bound =
      traverse_.startCost(problem_.start) + to_go_.cost(problem_.start, kNoDirection);
  if (found.lower_bound < kInfiniteCost) {
    // Upper bounds first: the best path without a tether, and the published search led to the goal.
    complete({problem_.start});
    LabelSearch published = searchFor(false);
    published.run(budget_, kWhat);
    keep(published.pathTo(goal_), published.costTo(goal_));

    LabelSearch exact = searchFor(true);
    exact.run(budget_, kWhat);
    keep(exact.pathTo(goal_), exact.costTo(goal_));
    if (budget_.reason() != nullptr) {
      complete(exact.openPath());
      found.lower_bound = std::max(found.lower_bound, exact.openCost());
    }
    found.expanded = published.expanded() + exact.expanded();
  }
  found.path = std::move(best_);
  found.cut = budget_.reason();
  found.refused = traverse_.refused();
  return found;
}

void GoalPlan::keep(std::vector<CellIndex> path, double cost) {
  if (path.empty() || !(cost < best_cost_)) return;
  best_ = std::move(path);
  best_cost_ = cost;
}

void GoalPlan::complete(std::vector<CellIndex> path) {
  if (path.empty()) return;
  const GridShape& shape = problem_.lattice->shape();
  Direction incoming = kNoDirection;
  if (path.size() > 1) {
    incoming = directionOf(shape.cell(path.back()) - shape.cell(path[path.size() - 2]));
  }
  while (path.back() != goal_) {
    incoming = to_go_.next(path.back(), incoming);
    if (incoming == kNoDirection) return;
    path.push_back(problem_.lattice->neighbour(path.back(), incoming));
  }
  const double cost = costOf(path);
  keep(std::move(path), cost);
}

double GoalPlan::costOf(const std::vector<CellIndex>& path) {
  const GridShape& shape = problem_.lattice->shape();
  TraverseState state = traverse_.start(path.front());
  double cost = traverse_.startCost(path.front());
  Direction incoming = kNoDirection;
  for (std::size_t i = 1; i < path.size() && cost < kInfiniteCost; ++i) {
    const Direction d = directionOf(shape.cell(path[i]) - shape.cell(path[i - 1]));
    cost += traverse_.step(state, path[i - 1], incoming, d, path[i]);
    incoming = d;
  }
  return cost;
}

PlanResult Tether::plan(const PlanProblem& problem, const PlanOptions& options,
                        const Progress& progress) const {
  needGoalOrRewards(problem, options);
  if (options.goal) {
    return concludeGoal(problem, options, GoalPlan(problem, options, progress).run());
  }
  Budget budget(options, progress);
  Traverse traverse(*problem.risk);
  LabelSearch search(*problem.lattice, traverse, problem.start, {.stacks = true});
  search.run(budget, kWhat);
  const PathsToAll paths{[&](CellIndex cell) { return search.costTo(cell); },
                         [&](CellIndex cell) { return search.pathTo(cell); }};
  return concludeAll(problem, options,
                     {paths, true, budget.reason(), search.expanded(), traverse.refused()},
                     progress);
}

}  // namespace

std::unique_ptr<Planner> makeTether() { return std::make_unique<Tether>(); }

}  // namespace tautline::planning
