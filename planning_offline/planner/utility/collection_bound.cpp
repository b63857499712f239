#include "planning_offline/planner/utility/collection_bound.h"

#include <algorithm>
#include <cmath>

#include "planning_offline/search/components.h"

namespace tautline::planning {

CollectionBound::Relaxation CollectionBound::relax(const PathPrefix& prefix,
                                                   std::span<const std::uint8_t> available) const {
  const double cost = prefix.so_far.cost;
  Relaxation r{prefix.leg_start, cost + collectibles_->costToGoal(prefix.cell)};
  const float* to = collectibles_->costsFrom(prefix.cell);
  if (to == nullptr) return r;
  double saved = kInfiniteCost;  // first leg: less than its least one by what was walked of it
  double nearest = kInfiniteCost;
  for (std::size_t k = 0; k < collectibles_->size(); ++k) {
    if (available[k] == 0) continue;
    const auto way = static_cast<double>(to[k]);
    saved = std::min(saved, way - collectibles_->items()[k].leg);
    nearest = std::min(nearest, way);
  }
  if (nearest == kInfiniteCost) return r;
  r.base = std::max(r.base, cost + saved);
  // Without a goal the path as it stands is a candidate of its own: only those that go on count.
  r.floor = std::max(r.floor, cost + nearest * (collectibles_->hasGoal() ? 0.0 : 1.0));
  return r;
}

template <class F>
void CollectionBound::forCorners(const PathPrefix& prefix, const Relaxation& relaxation,
                                 std::span<const std::uint8_t> available, F f) const {
  const double floor = relaxation.floor;
  if (floor > cost_cap_) return;
  double cost = relaxation.base;
  double reward = prefix.so_far.reward;
  if (cost > floor) f(floor, reward);
  for (std::size_t k = 0; k < collectibles_->size(); ++k) {
    if (available[k] == 0) continue;
    const Collectible& item = collectibles_->items()[k];
    const double next = cost + item.leg;
    if (cost <= floor && next > floor) {
      f(floor, reward + item.reward * std::max(0.0, floor - cost) / item.leg);
    }
    if (next > cost_cap_) {
      if (cost < cost_cap_) f(cost_cap_, reward + item.reward * (cost_cap_ - cost) / item.leg);
      return;
    }
    cost = next;
    reward += item.reward;
    if (cost > floor) f(cost, reward);
  }
  if (cost <= floor) f(floor, reward);
}

double CollectionBound::utility(const PathPrefix& prefix, std::span<const std::uint8_t> available,
                                Objective objective) const {
  if (objective == Objective::kExpectedReward) return expected(prefix, available);
  double best = 0.0;
  // R − u g(C) is convex on a straight piece of R, g concave: its greatest is at a corner.
  forCorners(prefix, relax(prefix, available), available, [&](double cost, double reward) {
    best = std::max(best, ratioOf(reward, riskOfCost(cost)));
  });
  return best;
}

double CollectionBound::expected(const PathPrefix& prefix,
                                 std::span<const std::uint8_t> available) const {
  const Relaxation r = relax(prefix, available);
  if (r.floor > cost_cap_) return 0.0;
  double in_order = 0.0;
  double survival = std::exp(-r.base);
  for (const std::size_t k : collectibles_->discountedOrder()) {
    if (available[k] == 0) continue;
    survival *= std::exp(-collectibles_->items()[k].leg);
    in_order += collectibles_->items()[k].reward * survival;
  }
  double each_first = 0.0;
  const double survival_here = std::exp(-prefix.so_far.cost);
  const float* to = collectibles_->costsFrom(prefix.cell);
  for (std::size_t k = 0; k < collectibles_->size(); ++k) {
    if (available[k] == 0) continue;
    const double way = to == nullptr ? 0.0 : static_cast<double>(to[k]);
    each_first += collectibles_->items()[k].reward * survival_here * std::exp(-way);
  }
  return prefix.so_far.expected + std::min(in_order, each_first);
}

bool CollectionBound::mayExtendFront(const PathPrefix& prefix,
                                     std::span<const std::uint8_t> available,
                                     const Candidates& found) const {
  constexpr double kMore = 1.0 + 1e-12;
  const Relaxation r = relax(prefix, available);
  bool may = false;
  auto next = found.front().upper_bound(r.floor);  // first point beyond the corner before
  double cost_before = r.floor;
  double reward_before = 0.0;
  forCorners(prefix, r, available, [&](double cost, double reward) {
    // The relaxation rises from the corner before to this one, the front jumps at its points.
    for (; next != found.front().end() && next->first <= cost && !may; ++next) {
      const double t = cost > cost_before ? (next->first - cost_before) / (cost - cost_before) : 1;
      const double at = reward_before + t * (reward - reward_before);
      may = next == found.front().begin() || at > std::prev(next)->second.reward * kMore;
    }
    may = may || next == found.front().begin() || reward > std::prev(next)->second.reward * kMore;
    cost_before = cost;
    reward_before = reward;
  });
  return may;
}

double CollectionBound::utilityFromStart(const Candidate& start, Objective objective) const {
  return objective == Objective::kRatio ? ratioFromStart(start) : expectedFromStart(start);
}

double CollectionBound::rewardFor(double cost, const Candidate& start) const {
  double left = std::max(0.0, cost - start.cost);
  double reward = start.reward;
  for (const Collectible& item : collectibles_->items()) {
    if (item.least_cost > cost) continue;
    if (item.leg > left) return reward + item.reward * left / item.leg;
    reward += item.reward;
    left -= item.leg;
  }
  return reward;
}

double CollectionBound::expectedFromStart(const Candidate& start) const {
  double alone = start.expected;
  for (const Collectible& item : collectibles_->items()) {
    alone += item.reward * std::exp(-item.least_cost);
  }
  double in_order = start.expected;
  double survival = std::exp(-start.cost);
  for (const std::size_t k : collectibles_->discountedOrder()) {
    survival *= std::exp(-collectibles_->items()[k].leg);
    in_order += collectibles_->items()[k].reward * survival;
  }
  return std::min({alone, in_order, rewardFor(cost_cap_, start)});
}

double CollectionBound::ratioFromStart(const Candidate& start) const {
  constexpr double kCertain = 40.0;  // 1 − e^{−40} is 1 in double
  const auto& items = collectibles_->items();
  double nearest = kInfiniteCost;
  double farthest = start.cost;
  for (const Collectible& item : items) {
    nearest = std::min(nearest, item.least_cost);
    farthest += item.leg;
  }
  double best = start.cost <= cost_cap_ ? ratioOf(start.reward, riskOfCost(start.cost)) : 0.0;
  if (items.empty() || nearest > cost_cap_) return best;
  // Between two costs of a geometric grid no path has more than the greater one buys.
  const double low = std::max(nearest, 1e-9);
  const double high = std::min({kCertain, cost_cap_, std::max(farthest, 2.0 * low)});
  const int steps = items.size() > 100'000 ? 100 : 400;
  const double factor = std::pow(std::max(1.0, high / low), 1.0 / steps);
  best = std::max(best, ratioOf(rewardFor(low, start), riskOfCost(nearest)));
  double from = low;
  for (int k = 0; k < steps; ++k) {
    const double to = from * factor;
    best = std::max(best, ratioOf(rewardFor(to, start), riskOfCost(from)));
    from = to;
  }
  if (cost_cap_ > high) {
    best = std::max(best, ratioOf(rewardFor(kInfiniteCost, start), riskOfCost(from)));
  }
  return best * (1.0 + 1e-12);  // the grid's ends are rounded
}

}  // namespace tautline::planning
