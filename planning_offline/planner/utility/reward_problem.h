#pragma once

/// @file
/// The problem of the utility planner, prepared: which paths count, what steps add to them, and
/// what they can be worth at most. Not real-time safe: offline only.

#include <cmath>
#include <optional>
#include <vector>

#include "planning_offline/planner/planner.h"
#include "planning_offline/planner/traverse.h"
#include "planning_offline/planner/utility/collectibles.h"
#include "planning_offline/planner/utility/collection_bound.h"
#include "planning_offline/planner/utility/path_prefix.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {

class RewardProblem {
 public:
  /// All must outlive it; `tree` is rooted at the problem's start.
  RewardProblem(const PlanProblem& problem, const PlanOptions& options, const LeastRiskTree& tree,
                const Progress& progress);

  [[nodiscard]] const Lattice& lattice() const noexcept { return *problem_->lattice; }
  [[nodiscard]] const PlanProblem& problem() const noexcept { return *problem_; }
  [[nodiscard]] const Collectibles& collectibles() const noexcept { return collectibles_; }
  [[nodiscard]] const CollectionBound& bound() const noexcept { return bound_; }
  [[nodiscard]] std::optional<CellIndex> goal() const noexcept { return goal_; }
  [[nodiscard]] Objective objective() const noexcept { return objective_; }

  /// Cells that some path within the risk cap may visit, ascending.
  [[nodiscard]] const std::vector<CellIndex>& reachable() const noexcept { return reachable_; }

  /// Limits of the tether that were met so far.
  [[nodiscard]] const BrokenLimits& refused() const noexcept { return traverse_.refused(); }

  [[nodiscard]] bool mayEndAt(CellIndex cell) const noexcept { return !goal_ || *goal_ == cell; }
  [[nodiscard]] bool withinCap(const PathPrefix& path) const noexcept {
    return std::isfinite(path.so_far.cost) && path.so_far.cost <= bound_.costCap();
  }

  [[nodiscard]] PathPrefix start();
  /// `first_visit`: the path has not been in the cell that the step leads to.
  [[nodiscard]] PathPrefix extend(const PathPrefix& from, Direction d, bool first_visit);
  /// The simple path `from` + `leg`, whose first cell is the end of `from`. Empty if it goes beyond
  /// the cap or is not a path on the lattice.
  [[nodiscard]] std::optional<PathPrefix> follow(const PathPrefix& from,
                                                 const std::vector<CellIndex>& leg);

 private:
  const PlanProblem* problem_;
  std::optional<CellIndex> goal_;
  Objective objective_;
  Traverse traverse_;
  double cost_cap_;
  Collectibles collectibles_;
  CollectionBound bound_;
  std::vector<CellIndex> reachable_;
};

}  // namespace tautline::planning
