#pragma once

/// @file
/// The rewards that paths from one start can still collect, and the least that getting from one to
/// the next costs. Not real-time safe: offline only.

#include <cstddef>
#include <optional>
#include <vector>

#include "planning_offline/planner/planner.h"
#include "planning_offline/planner/traverse.h"
#include "planning_offline/progress.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {

/// A cell with a reward, other than the start.
struct Collectible {
  CellIndex cell{kNoCell};
  double reward{0.0};
  double least_cost{0.0};  ///< No path from the start to it costs less.
  double leg{0.0};         ///< No way to it from the start or from another collectible costs less.
};

class Collectibles {
 public:
  /// `tree` is rooted at the problem's start. Rewards that no path of at most `cost_cap` reaches
  /// are left out.
  Collectibles(const PlanProblem& problem, Traverse& traverse, const LeastRiskTree& tree,
               double cost_cap, std::optional<CellIndex> goal, const Progress& progress);

  /// By falling reward / leg: the order of the fractional knapsack.
  [[nodiscard]] const std::vector<Collectible>& items() const noexcept { return items_; }
  [[nodiscard]] std::size_t size() const noexcept { return items_.size(); }
  /// Indices into items() by falling ρ e^{−leg} / (1 − e^{−leg}): the order that discounted
  /// collection is best in.
  [[nodiscard]] const std::vector<std::size_t>& discountedOrder() const noexcept {
    return discounted_order_;
  }
  /// Index into items(), or -1.
  [[nodiscard]] int itemAt(CellIndex cell) const noexcept {
    return item_at_[static_cast<std::size_t>(cell)];
  }
  [[nodiscard]] double startReward() const noexcept { return start_reward_; }

  /// Lower bounds of the cost from `cell` to each item; null where the table would be too large.
  [[nodiscard]] const float* costsFrom(CellIndex cell) const noexcept {
    return table_.empty() ? nullptr : &table_[static_cast<std::size_t>(cell) * items_.size()];
  }
  [[nodiscard]] bool hasGoal() const noexcept { return !to_goal_.empty(); }
  /// Lower bound of the cost from `cell` to the goal; 0 without a goal.
  [[nodiscard]] double costToGoal(CellIndex cell) const noexcept {
    return to_goal_.empty() ? 0.0 : to_goal_[static_cast<std::size_t>(cell)];
  }

 private:
  void index();
  void findLegs(const PlanProblem& problem, Traverse& traverse, const Progress& progress);
  void sort();
  void fillTable(const PlanProblem& problem, Traverse& traverse, const Progress& progress);

  std::vector<Collectible> items_;
  std::vector<std::size_t> discounted_order_;
  std::vector<int> item_at_;
  double start_reward_{0.0};
  std::vector<float> table_;  ///< [cell][item], rounded down.
  std::vector<double> to_goal_;
};

}  // namespace tautline::planning
