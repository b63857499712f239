#pragma once

/// @file
/// What any continuation of a path can be worth at most. Relaxation: the rewards still to be had
/// may be collected in any order and in fractions, each for the least cost of a leg to it (a
/// fractional knapsack). docs/utility.md derives each bound. Not real-time safe: offline only.

#include <cstdint>
#include <span>

#include "planning_offline/planner/utility/candidates.h"
#include "planning_offline/planner/utility/collectibles.h"
#include "planning_offline/planner/utility/path_prefix.h"

namespace tautline::planning {

class CollectionBound {
 public:
  /// Paths of a cost above `cost_cap` do not count.
  CollectionBound(const Collectibles& collectibles, double cost_cap)
      : collectibles_(&collectibles), cost_cap_(cost_cap) {}

  [[nodiscard]] double costCap() const noexcept { return cost_cap_; }

  /// No continuation has more utility. `available`: one byte an item, 0 = taken or out of reach.
  [[nodiscard]] double utility(const PathPrefix& prefix, std::span<const std::uint8_t> available,
                               Objective objective) const;

  /// True if some continuation could be better than the front: neither riskier nor poorer than all
  /// of its points.
  [[nodiscard]] bool mayExtendFront(const PathPrefix& prefix,
                                    std::span<const std::uint8_t> available,
                                    const Candidates& found) const;

  /// No path from the start has more utility. `start` is that of staying there. Tighter than
  /// utility() where rewards are far: a reward counts only from the cost of its least-risk path on.
  [[nodiscard]] double utilityFromStart(const Candidate& start, Objective objective) const;

 private:
  /// The relaxation's best reward against cost: from `base` and the prefix's reward in straight
  /// pieces, one an item; only costs of at least `floor` occur.
  struct Relaxation {
    double base{0.0};
    double floor{0.0};
  };
  [[nodiscard]] Relaxation relax(const PathPrefix& prefix,
                                 std::span<const std::uint8_t> available) const;
  /// Calls f(cost, reward) at the ends of the pieces, by rising cost, up to the cap.
  template <class F>
  void forCorners(const PathPrefix& prefix, const Relaxation& relaxation,
                  std::span<const std::uint8_t> available, F f) const;
  [[nodiscard]] double expected(const PathPrefix& prefix,
                                std::span<const std::uint8_t> available) const;
  [[nodiscard]] double ratioFromStart(const Candidate& start) const;
  [[nodiscard]] double expectedFromStart(const Candidate& start) const;
  /// No path of at most this cost has more reward.
  [[nodiscard]] double rewardFor(double cost, const Candidate& start) const;

  const Collectibles* collectibles_;
  double cost_cap_;
};

}  // namespace tautline::planning
