#include "planning_offline/planner/utility/collectibles.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <utility>

#include "planning_offline/search/components.h"

namespace tautline::planning {
namespace {

constexpr std::size_t kTableLimit = std::size_t{1} << 22;  // entries: a few seconds of search

/// Backward search over the least that each step may cost, whatever came before: how cheaply a cell
/// can be reached from any other.
class BackwardSearch {
 public:
  BackwardSearch(const PlanProblem& problem, Traverse& traverse)
      : lattice_(problem.lattice),
        risk_(problem.risk),
        traverse_(&traverse),
        cost_(problem.lattice->shape().size(), kInfiniteCost) {}

  /// Settles cells in order of their cost to `target` until `stop(cell)` holds for one that is not
  /// the target; returns that one's cost, infinite if there is none.
  template <class Stop>
  double run(CellIndex target, const Stop& stop) {
    for (const CellIndex i : touched_) cost_[static_cast<std::size_t>(i)] = kInfiniteCost;
    touched_.clear();
    queue_ = {};
    relax(target, 0.0);
    while (!queue_.empty()) {
      const auto [cost, v] = queue_.top();
      queue_.pop();
      if (cost > cost_[static_cast<std::size_t>(v)]) continue;
      if (v != target && stop(v)) return cost;
      const std::uint32_t moves = lattice_->moves(v);  // a move is allowed both ways or not at all
      for (const Direction back : lattice_->directions()) {
        if ((moves >> back & 1U) == 0) continue;
        const CellIndex u = lattice_->neighbour(v, back);
        relax(u, cost + leastStep(u, opposite(back), v));
      }
    }
    return kInfiniteCost;
  }

  [[nodiscard]] const std::vector<double>& cost() const noexcept { return cost_; }

 private:
  [[nodiscard]] double leastStep(CellIndex u, Direction d, CellIndex v) const {
    return risk_->stepCost(u, d, d, v) + traverse_->tetherBound(v, d);  // straight on: no turn
  }
  void relax(CellIndex u, double cost) {
    double& old = cost_[static_cast<std::size_t>(u)];
    if (cost >= old) return;
    if (old == kInfiniteCost) touched_.push_back(u);
    old = cost;
    queue_.emplace(cost, u);
  }

  using Entry = std::pair<double, CellIndex>;
  const Lattice* lattice_;
  const RiskModel* risk_;
  Traverse* traverse_;
  std::vector<double> cost_;
  std::vector<CellIndex> touched_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

constexpr auto kNowhere = [](CellIndex) { return false; };

float roundedDown(double x) {
  const auto f = static_cast<float>(x);
  return static_cast<double>(f) > x ? std::nextafter(f, 0.0F) : f;
}

}  // namespace

Collectibles::Collectibles(const PlanProblem& problem, Traverse& traverse,
                           const LeastRiskTree& tree, double cost_cap,
                           std::optional<CellIndex> goal, const Progress& progress)
    : item_at_(problem.lattice->shape().size(), -1) {
  for (std::size_t i = 0; i < problem.reward.size(); ++i) {
    const auto cell = static_cast<CellIndex>(i);
    if (!(problem.reward[i] > 0.0) || !problem.lattice->free(cell)) continue;
    if (cell == problem.start) {
      start_reward_ = problem.reward[i];
      continue;
    }
    const double least = tree.costTo(cell) - tree.costError();
    if (least <= cost_cap && least < kInfiniteCost) {
      items_.push_back({cell, problem.reward[i], least, 0.0});
    }
  }
  index();
  findLegs(problem, traverse, progress);
  sort();
  index();
  if (goal) {
    BackwardSearch search(problem, traverse);
    search.run(*goal, kNowhere);
    to_goal_ = search.cost();
  }
  if (items_.size() * item_at_.size() <= kTableLimit) fillTable(problem, traverse, progress);
}

void Collectibles::index() {
  for (std::size_t k = 0; k < items_.size(); ++k) {
    item_at_[static_cast<std::size_t>(items_[k].cell)] = static_cast<int>(k);
  }
}

void Collectibles::sort() {
  std::sort(items_.begin(), items_.end(), [](const Collectible& a, const Collectible& b) {
    return std::pair(a.leg / a.reward, a.cell) < std::pair(b.leg / b.reward, b.cell);
  });
  discounted_order_.resize(items_.size());
  std::iota(discounted_order_.begin(), discounted_order_.end(), std::size_t{0});
  const auto key = [this](std::size_t k) { return std::expm1(items_[k].leg) / items_[k].reward; };
  std::stable_sort(discounted_order_.begin(), discounted_order_.end(),
                   [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
}

void Collectibles::findLegs(const PlanProblem& problem, Traverse& traverse,
                            const Progress& progress) {
  BackwardSearch search(problem, traverse);
  const auto collectible = [&](CellIndex i) { return i == problem.start || itemAt(i) >= 0; };
  for (std::size_t k = 0; k < items_.size() && !progress.cancelled(); ++k) {
    if (k % 4096 == 0) {
      progress.report("ways between rewards",
                      static_cast<double>(k) / static_cast<double>(items_.size()));
    }
    items_[k].leg = search.run(items_[k].cell, collectible);
  }
}

void Collectibles::fillTable(const PlanProblem& problem, Traverse& traverse,
                             const Progress& progress) {
  table_.assign(items_.size() * item_at_.size(), 0.0F);
  BackwardSearch search(problem, traverse);
  for (std::size_t k = 0; k < items_.size() && !progress.cancelled(); ++k) {
    search.run(items_[k].cell, kNowhere);
    for (std::size_t i = 0; i < item_at_.size(); ++i) {
      table_[i * items_.size() + k] = roundedDown(search.cost()[i]);
    }
  }
}

}  // namespace tautline::planning
