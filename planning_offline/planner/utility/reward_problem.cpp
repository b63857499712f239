#include "planning_offline/planner/utility/reward_problem.h"

#include "planning_offline/search/components.h"

namespace tautline::planning {

RewardProblem::RewardProblem(const PlanProblem& problem, const PlanOptions& options,
                             const LeastRiskTree& tree, const Progress& progress)
    : problem_(&problem),
      goal_(options.goal),
      objective_(options.objective),
      traverse_(*problem.risk),
      cost_cap_(costOfRisk(options.risk_cap)),
      collectibles_(problem, traverse_, tree, cost_cap_, options.goal, progress),
      bound_(collectibles_, cost_cap_) {
  for (std::size_t i = 0; i < lattice().shape().size(); ++i) {
    const auto cell = static_cast<CellIndex>(i);
    if (!lattice().free(cell)) continue;
    const double least = tree.costTo(cell) - tree.costError();
    if (least <= cost_cap_ && least < kInfiniteCost) reachable_.push_back(cell);
  }
}

PathPrefix RewardProblem::start() {
  const double cost = traverse_.startCost(problem_->start);
  const double reward = collectibles_.startReward();
  return {problem_->start,
          kNoDirection,
          traverse_.start(problem_->start),
          {cost, reward, reward * std::exp(-cost)},
          cost};
}

PathPrefix RewardProblem::extend(const PathPrefix& from, Direction d, bool first_visit) {
  PathPrefix path = from;
  path.cell = lattice().neighbour(from.cell, d);
  path.incoming = d;
  path.so_far.cost += traverse_.step(path.traverse, from.cell, from.incoming, d, path.cell);
  const int item = collectibles_.itemAt(path.cell);
  if (item < 0) return path;
  path.leg_start = path.so_far.cost;
  if (first_visit) {
    const double reward = collectibles_.items()[static_cast<std::size_t>(item)].reward;
    path.so_far.reward += reward;
    path.so_far.expected += reward * std::exp(-path.so_far.cost);
  }
  return path;
}

std::optional<PathPrefix> RewardProblem::follow(const PathPrefix& from,
                                                const std::vector<CellIndex>& leg) {
  const GridShape& shape = lattice().shape();
  PathPrefix path = from;
  for (std::size_t i = 1; i < leg.size() && withinCap(path); ++i) {
    const Direction d = directionOf(shape.cell(leg[i]) - shape.cell(leg[i - 1]));
    path = extend(path, d, true);
  }
  if (!withinCap(path)) return std::nullopt;
  return path;
}

}  // namespace tautline::planning
