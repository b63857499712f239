#include "planning_offline/planner/utility/beam_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace tautline::planning {
namespace {

constexpr std::size_t kPerCell = 8;         // labels of one level in one cell
constexpr std::size_t kWork = 400'000'000;  // steps and words copied in one pass
constexpr int kPasses = 6;

class Beam {
 public:
  Beam(RewardProblem& problem, std::size_t width, Candidates& found);

  void run(Budget& budget);

 private:
  struct Label {
    PathPrefix path;
    std::size_t node{0};        // in tree_
    std::uint64_t set_hash{0};  // of the cells visited, whatever their order
    double score{0.0};
    std::size_t parent{0};  // in the level before
  };
  struct Node {
    CellIndex cell;
    std::size_t parent;
  };

  [[nodiscard]] std::vector<Label> children(Budget& budget);
  void keepBest(std::vector<Label> all);
  [[nodiscard]] double score(const Candidate& c) const;
  [[nodiscard]] std::vector<CellIndex> pathTo(std::size_t node) const;
  [[nodiscard]] bool visited(std::size_t label, CellIndex cell) const;
  void markVisited(std::size_t label, CellIndex cell);

  RewardProblem* problem_;
  std::size_t width_;
  Candidates* found_;
  double mu_{0.0};
  double worth_{0.0};  // of surviving, expected reward only
  std::vector<std::int32_t> bit_at_;
  std::size_t words_{0};
  std::vector<Label> level_;
  std::vector<std::uint64_t> sets_;  // words_ a label of the level
  std::vector<Node> tree_;
};

std::uint64_t hashOf(CellIndex cell) {
  std::uint64_t h = (static_cast<std::uint64_t>(cell) + 1) * 0x9e3779b97f4a7c15U;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9U;
  return h ^ (h >> 27);
}

Beam::Beam(RewardProblem& problem, std::size_t width, Candidates& found)
    : problem_(&problem),
      width_(width),
      found_(&found),
      bit_at_(problem.lattice().shape().size(), -1) {
  std::int32_t count = 0;
  for (const CellIndex cell : problem.reachable()) {
    bit_at_[static_cast<std::size_t>(cell)] = count++;
  }
  words_ = static_cast<std::size_t>(count) / 64 + 1;
  if (!found.empty()) {
    mu_ = found.utility() * std::exp(-found.best().cost);
    worth_ = found.utility();
  }
}

void Beam::run(Budget& budget) {
  Label start{problem_->start(), 0, 0, 0.0, 0};
  if (!problem_->withinCap(start.path)) return;
  tree_.push_back({start.path.cell, 0});
  sets_.assign(words_, 0);
  level_.push_back(start);
  markVisited(0, start.path.cell);
  const std::size_t steps = problem_->lattice().directions().size();
  for (std::size_t work = 0; work < kWork && !level_.empty();) {
    work += level_.size() * (steps + words_);
    keepBest(children(budget));
  }
}

std::vector<Beam::Label> Beam::children(Budget& budget) {
  std::vector<Label> all;
  const Lattice& lattice = problem_->lattice();
  for (std::size_t i = 0; i < level_.size(); ++i) {
    if (budget.spent(0, "paths by beam search")) return {};
    const Label& from = level_[i];
    const std::uint32_t moves = lattice.moves(from.path.cell);
    for (const Direction d : lattice.directions()) {
      if ((moves >> d & 1U) == 0) continue;
      const CellIndex to = lattice.neighbour(from.path.cell, d);
      if (bit_at_[static_cast<std::size_t>(to)] < 0 || visited(i, to)) continue;
      Label label{problem_->extend(from.path, d, true), 0, from.set_hash ^ hashOf(to), 0.0, i};
      if (!problem_->withinCap(label.path)) continue;
      label.score = score(label.path.so_far);
      if (problem_->mayEndAt(to)) {
        found_->offer(label.path.so_far, [&] {
          std::vector<CellIndex> path = pathTo(from.node);
          path.push_back(to);
          return path;
        });
        if (problem_->goal()) continue;  // a simple path ends there
      }
      all.push_back(label);
    }
  }
  return all;
}

void Beam::keepBest(std::vector<Label> all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Label& a, const Label& b) { return a.score > b.score; });
  std::unordered_set<std::uint64_t> kept_sets;
  std::unordered_map<CellIndex, std::size_t> in_cell;
  std::vector<Label> kept;
  std::vector<std::uint64_t> sets;
  for (Label& label : all) {
    if (kept.size() == width_) break;
    const CellIndex cell = label.path.cell;
    if (in_cell[cell] == kPerCell || !kept_sets.insert(label.set_hash * 31 + hashOf(cell)).second) {
      continue;
    }
    ++in_cell[cell];
    const auto parent = sets_.begin() + static_cast<std::ptrdiff_t>(label.parent * words_);
    sets.insert(sets.end(), parent, parent + static_cast<std::ptrdiff_t>(words_));
    label.node = tree_.size();
    tree_.push_back({cell, level_[label.parent].node});
    kept.push_back(label);
  }
  level_ = std::move(kept);
  sets_ = std::move(sets);
  for (std::size_t i = 0; i < level_.size(); ++i) markVisited(i, level_[i].path.cell);
}

double Beam::score(const Candidate& c) const {
  if (problem_->objective() == Objective::kRatio) return c.reward - mu_ * c.cost;
  return c.expected + worth_ * std::exp(-c.cost);
}

std::vector<CellIndex> Beam::pathTo(std::size_t node) const {
  std::vector<CellIndex> path;
  for (; node != 0; node = tree_[node].parent) path.push_back(tree_[node].cell);
  path.push_back(tree_[0].cell);
  std::reverse(path.begin(), path.end());
  return path;
}

bool Beam::visited(std::size_t label, CellIndex cell) const {
  const auto bit = static_cast<std::size_t>(bit_at_[static_cast<std::size_t>(cell)]);
  return (sets_[label * words_ + bit / 64] >> (bit % 64) & 1U) != 0;
}

void Beam::markVisited(std::size_t label, CellIndex cell) {
  const auto bit = static_cast<std::size_t>(bit_at_[static_cast<std::size_t>(cell)]);
  sets_[label * words_ + bit / 64] |= std::uint64_t{1} << (bit % 64);
}

}  // namespace

void beamSearch(RewardProblem& problem, std::size_t width, Candidates& found, Budget& budget) {
  for (int pass = 0; pass < kPasses && budget.reason() == nullptr; ++pass) {
    const double before = found.utility();
    Beam(problem, width, found).run(budget);
    if (found.utility() <= before) return;
  }
}

}  // namespace tautline::planning
