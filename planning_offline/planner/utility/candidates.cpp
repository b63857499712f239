#include "planning_offline/planner/utility/candidates.h"

#include <iterator>
#include <utility>

namespace tautline::planning {
namespace {

// Rewards and costs that differ by less are sums of the same numbers in another order.
constexpr double kRounding = 1e-12;

}  // namespace

void Candidates::offer(const Candidate& candidate, const Path& path) {
  offerToFront(candidate, path);
  const double utility = candidate.utility(objective_);
  const bool better = utility > utility_ || (utility == utility_ && candidate.cost < best_.cost);
  if (!better) return;
  utility_ = utility;
  best_ = candidate;
  best_path_ = path();
}

void Candidates::offerToFront(const Candidate& candidate, const Path& path) {
  auto next = front_.upper_bound(candidate.cost * (1.0 + kRounding));
  if (next != front_.begin() &&
      std::prev(next)->second.reward >= candidate.reward * (1.0 - kRounding)) {
    return;
  }
  next = front_.lower_bound(candidate.cost);
  while (next != front_.end() && next->second.reward <= candidate.reward * (1.0 + kRounding)) {
    next = front_.erase(next);
  }
  front_.emplace(candidate.cost, OnFront{candidate.reward, path()});
}

}  // namespace tautline::planning
