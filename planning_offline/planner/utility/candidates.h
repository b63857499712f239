#pragma once

/// @file
/// What a reward search has found so far: the best path, and the front of reward against risk. Not
/// real-time safe: offline only.

#include <functional>
#include <map>
#include <vector>

#include "planning_offline/planner/planner.h"

namespace tautline::planning {

/// A path that may be the answer.
struct Candidate {
  double cost{0.0};
  double reward{0.0};
  double expected{0.0};  ///< Σ_i reward_i Π_{j<=i} (1 − r_j)

  [[nodiscard]] double utility(Objective objective) const noexcept {
    return objective == Objective::kRatio ? ratioOf(reward, riskOfCost(cost)) : expected;
  }
};

class Candidates {
 public:
  using Path = std::function<std::vector<CellIndex>()>;

  explicit Candidates(Objective objective) : objective_(objective) {}

  /// `path` is asked only if the candidate is worth keeping.
  void offer(const Candidate& candidate, const Path& path);

  [[nodiscard]] bool empty() const noexcept { return best_path_.empty(); }
  [[nodiscard]] const Candidate& best() const noexcept { return best_; }
  [[nodiscard]] const std::vector<CellIndex>& bestPath() const noexcept { return best_path_; }
  /// Of the best; below everything while there is none.
  [[nodiscard]] double utility() const noexcept { return utility_; }
  [[nodiscard]] Objective objective() const noexcept { return objective_; }

  struct OnFront {
    double reward{0.0};
    std::vector<CellIndex> path;
  };
  /// By cost; reward rises with it.
  [[nodiscard]] const std::map<double, OnFront>& front() const noexcept { return front_; }

 private:
  void offerToFront(const Candidate& candidate, const Path& path);

  Objective objective_;
  Candidate best_;
  double utility_{-1.0};
  std::vector<CellIndex> best_path_;
  std::map<double, OnFront> front_;
};

}  // namespace tautline::planning
