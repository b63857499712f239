#include "planning_offline/planner/utility/leg_chain.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace tautline::planning {
namespace {

constexpr int kIdleLegs = 8;            // legs without a better path before it gives up
constexpr std::size_t kTargets = 2000;  // rewards tried a leg, the richest for their legs

class Chain {
 public:
  Chain(RewardProblem& problem, const Progress& progress, Candidates& found, Budget& budget)
      : problem_(&problem), progress_(&progress), found_(&found), budget_(&budget) {}

  void run(const LeastRiskTree& root, int threads);

 private:
  struct Leg {
    std::vector<CellIndex> cells;
    PathPrefix end;
    double score{0.0};
  };

  [[nodiscard]] std::optional<Leg> follow(const LeastRiskTree& tree, CellIndex target);
  [[nodiscard]] std::optional<Leg> bestLeg(const LeastRiskTree& tree);
  void offer(const Leg& leg);
  [[nodiscard]] Lattice unvisited() const;

  RewardProblem* problem_;
  const Progress* progress_;
  Candidates* found_;
  Budget* budget_;
  std::vector<CellIndex> path_;
  PathPrefix prefix_;
};

void Chain::run(const LeastRiskTree& root, int threads) {
  prefix_ = problem_->start();
  path_ = {prefix_.cell};
  if (!problem_->withinCap(prefix_)) return;
  std::optional<Lattice> lattice;
  std::unique_ptr<LeastRiskTree> tree;
  for (int idle = 0; idle < kIdleLegs && budget_->reason() == nullptr; ++idle) {
    const double before = found_->utility();
    const LeastRiskTree& from = tree ? *tree : root;
    if (problem_->goal()) {
      if (const auto last = follow(from, *problem_->goal())) offer(*last);
    }
    const auto leg = bestLeg(from);
    if (!leg) return;
    path_.insert(path_.end(), leg->cells.begin() + 1, leg->cells.end());
    prefix_ = leg->end;
    if (found_->utility() > before) idle = -1;
    tree.reset();  // it looks at the lattice
    lattice.emplace(unvisited());
    tree = leastRiskTree(*lattice, *problem_->problem().risk, prefix_.cell, threads, *progress_);
  }
}

std::optional<Chain::Leg> Chain::follow(const LeastRiskTree& tree, CellIndex target) {
  Leg leg;
  leg.cells = tree.pathTo(target);
  if (leg.cells.size() < 2) return std::nullopt;
  std::vector<CellIndex> sorted = leg.cells;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return std::nullopt;
  const auto end = problem_->follow(prefix_, leg.cells);
  if (!end) return std::nullopt;
  leg.end = *end;
  const Candidate& c = end->so_far;
  const double mu = found_->empty() ? 0.0 : found_->utility() * std::exp(-found_->best().cost);
  leg.score = problem_->objective() == Objective::kRatio ? c.reward - mu * c.cost : c.expected;
  return leg;
}

std::optional<Chain::Leg> Chain::bestLeg(const LeastRiskTree& tree) {
  std::optional<Leg> best;
  std::size_t tried = 0;
  for (const Collectible& item : problem_->collectibles().items()) {
    if (tried == kTargets || budget_->spent(0, "legs between rewards")) break;
    if (item.cell == prefix_.cell || item.cell == problem_->goal()) continue;
    if (!std::isfinite(tree.costTo(item.cell))) continue;  // visited, or out of reach
    ++tried;
    auto leg = follow(tree, item.cell);
    if (!leg) continue;
    if (problem_->goal() &&
        std::find(leg->cells.begin(), leg->cells.end(), *problem_->goal()) != leg->cells.end()) {
      continue;
    }
    if (!problem_->goal()) offer(*leg);
    if (!best || leg->score > best->score) best = std::move(leg);
  }
  return best;
}

void Chain::offer(const Leg& leg) {
  found_->offer(leg.end.so_far, [&] {
    std::vector<CellIndex> path = path_;
    path.insert(path.end(), leg.cells.begin() + 1, leg.cells.end());
    return path;
  });
}

Lattice Chain::unvisited() const {
  const Lattice& all = problem_->lattice();
  std::vector<std::uint8_t> free(all.freeCells().begin(), all.freeCells().end());
  for (const CellIndex cell : path_) free[static_cast<std::size_t>(cell)] = 0;
  free[static_cast<std::size_t>(prefix_.cell)] = 1;
  return {all.shape(), all.connectivity(), std::move(free)};
}

}  // namespace

void chainLegs(RewardProblem& problem, const LeastRiskTree& tree, int threads,
               const Progress& progress, Candidates& found, Budget& budget) {
  Chain(problem, progress, found, budget).run(tree, threads);
}

}  // namespace tautline::planning
