#include "planning_offline/planner/choose_goal.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/error.h"
#include "planning_offline/planner/budget.h"

namespace tautline::planning {
namespace {

/// What the best path to a cell can have collected at most: most cells then need no path at all. A
/// reward on the way to a cell has itself been reached for no more, and the way on from there costs
/// what actions of that length cost at least.
class RewardsBehind {
 public:
  RewardsBehind(const PlanProblem& problem, const PathsToAll& paths) : map_(&problem.risk->map()) {
    for (std::size_t i = 0; i < problem.reward.size(); ++i) {
      const auto cell = static_cast<CellIndex>(i);
      if (!(problem.reward[i] > 0.0) || !problem.lattice->free(cell)) continue;
      sum_ += problem.reward[i];
      if (sources_.size() > kSourcesMax) continue;
      sources_.push_back({problem.reward[i], paths.cost(cell), map_->centre(cell)});
    }
    per_metre_ = std::numeric_limits<double>::infinity();
    for (const Direction d : problem.lattice->directions()) {
      const double cost = problem.risk->costs().action[static_cast<std::size_t>(d)];
      per_metre_ = std::min(per_metre_, cost / (stepLength(d) * map_->resolution));
    }
  }

  [[nodiscard]] double most(CellIndex cell, double cost) const {
    if (sources_.size() > kSourcesMax) return sum_;
    const double allowed = cost * (1.0 + kRounding) + kRounding;
    const Eigen::Vector3d p = map_->centre(cell);
    double sum = 0.0;
    for (const Source& source : sources_) {
      const double way = per_metre_ * (p - source.position).norm();
      if (source.cost + way <= allowed) sum += source.reward;
    }
    return sum;
  }

 private:
  struct Source {
    double reward;
    double cost;
    Eigen::Vector3d position;
  };
  static constexpr std::size_t kSourcesMax =
      256;                                   // beyond, looking at each costs more than it saves
  static constexpr double kRounding = 1e-3;  // far above the error of any search's costs

  const VoxelMap* map_;
  std::vector<Source> sources_;
  double sum_{0.0};
  double per_metre_{0.0};
};

}  // namespace

void needGoalOrRewards(const PlanProblem& problem, const PlanOptions& options) {
  const bool rewarded = std::any_of(problem.reward.begin(), problem.reward.end(),
                                    [](double reward) { return reward > 0.0; });
  if (options.goal || rewarded) return;
  throw InputError({.problem = "neither a goal nor rewards",
                    .remedy = "give a goal, or a map with rewards to choose one by"},
                   ExitCode::kUsage);
}

std::optional<GoalChoice> chooseGoal(const PlanProblem& problem, const PlanOptions& options,
                                     const PathsToAll& paths, const Progress& progress) {
  const RewardsBehind behind(problem, paths);
  const bool expected = options.objective == Objective::kExpectedReward;
  const auto cells = static_cast<CellIndex>(problem.lattice->shape().size());
  std::optional<GoalChoice> best;
  double best_cost = 0.0;
  const auto consider = [&](CellIndex cell) {
    const double cost = paths.cost(cell);
    const double risk = riskOfCost(cost);
    if (!std::isfinite(cost) || risk > options.risk_cap) return;
    const double most = behind.most(cell, cost);
    if (best && (expected ? most : ratioOf(most, risk)) < best->utility) return;
    std::vector<CellIndex> path = paths.path(cell);
    const double reward = rewardOf(problem.reward, path);
    double utility = ratioOf(reward, risk);
    if (expected) {
      if (best && reward < best->utility) return;
      utility = utilityOf(problem.reward, path, problem.risk->evaluate(path), options.objective);
    }
    if (!best || utility > best->utility || (utility == best->utility && cost < best_cost)) {
      best = GoalChoice{cell, std::move(path), utility};
      best_cost = cost;
    }
  };
  consider(problem.start);
  // Ends with a reward first: another end is rarely better, and time may be short.
  Budget budget(options, progress);
  for (const bool rewarded : {true, false}) {
    for (CellIndex cell = 0; cell < cells; ++cell) {
      if (budget.spent(0, "choosing the goal")) break;
      const bool has =
          !problem.reward.empty() && problem.reward[static_cast<std::size_t>(cell)] > 0.0;
      if (cell != problem.start && has == rewarded && problem.lattice->free(cell)) consider(cell);
    }
  }
  if (best) best->cut = budget.reason();
  return best;
}

}  // namespace tautline::planning
