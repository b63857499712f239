#include "planning_offline/planner/utility/reward_search.h"

#include <algorithm>

namespace tautline::planning {
namespace {

constexpr std::size_t kMemory = std::size_t{1} << 30;  // bytes of labels
constexpr std::size_t kOverhead = 64;                  // bytes a label in queue and hash table

bool has(std::span<const std::uint64_t> bits, int i) {
  return (bits[static_cast<std::size_t>(i) / 64] >> (i % 64) & 1U) != 0;
}
void put(std::span<std::uint64_t> bits, int i) {
  bits[static_cast<std::size_t>(i) / 64] |= std::uint64_t{1} << (i % 64);
}

}  // namespace

RewardSearch::RewardSearch(RewardProblem& problem, Over over, Aim aim, Candidates& found)
    : problem_(&problem),
      over_(over),
      aim_(aim),
      found_(&found),
      bit_at_(problem.lattice().shape().size(), -1),
      available_(problem.collectibles().size(), 0) {
  int count = 0;
  for (const CellIndex cell : problem.reachable()) {
    if (over == Over::kSimple || problem.collectibles().itemAt(cell) >= 0) {
      bit_at_[static_cast<std::size_t>(cell)] = count++;
    }
  }
  words_ = static_cast<std::size_t>(count) / 64 + 1;
  set_.assign(words_, 0);
  begin();
}

void RewardSearch::begin() {
  const PathPrefix start = problem_->start();
  if (!problem_->withinCap(start)) return;
  const int bit = bit_at_[static_cast<std::size_t>(start.cell)];
  if (bit >= 0) put(set_, bit);
  consider(start, kNone);
}

void RewardSearch::run(Budget& budget) {
  const std::size_t bytes = sizeof(Label) + words_ * sizeof(Word) + kOverhead;
  const std::size_t label_limit = kMemory / bytes;
  const char* what = aim_ == Aim::kBest ? "paths by utility" : "front of reward and risk";
  while (!open_.empty()) {
    const auto [bound, id] = open_.top();
    if (aim_ == Aim::kBest && bound <= toBeat()) break;
    if (labels_.size() >= label_limit ||
        budget.spent(static_cast<std::int64_t>(labels_.size()), what)) {
      return;
    }
    open_.pop();
    if (!labels_[static_cast<std::size_t>(id)].dominated) expand(id);
  }
  exhausted_ = true;
}

double RewardSearch::upperBound() const {
  const double open = exhausted_ || open_.empty() ? -1.0 : open_.top().first;
  return std::max(toBeat(), open);
}

double RewardSearch::toBeat() const { return std::max(found_->utility(), best_walk_); }

void RewardSearch::expand(Id id) {
  ++expanded_;
  const PathPrefix from = labels_[static_cast<std::size_t>(id)].path;
  const Lattice& lattice = problem_->lattice();
  const std::uint32_t moves = lattice.moves(from.cell);
  for (const Direction d : lattice.directions()) {
    if ((moves >> d & 1U) == 0) continue;
    const CellIndex to = lattice.neighbour(from.cell, d);
    const int bit = bit_at_[static_cast<std::size_t>(to)];
    if (over_ == Over::kSimple && bit < 0) continue;  // beyond the cap whatever the way
    const auto before = bitsOf(id);
    const bool first_visit = bit < 0 || !has(before, bit);
    if (over_ == Over::kSimple && !first_visit) continue;
    const PathPrefix path = problem_->extend(from, d, first_visit);
    if (!problem_->withinCap(path)) continue;
    set_.assign(before.begin(), before.end());
    if (bit >= 0) put(set_, bit);
    consider(path, id);
  }
}

void RewardSearch::consider(const PathPrefix& path, Id parent) {
  const CellIndex cell = path.cell;
  if (problem_->mayEndAt(cell)) {
    if (over_ == Over::kSimple) {
      found_->offer(path.so_far, [&] { return pathTo(cell, parent); });
    } else if (const double utility = path.so_far.utility(problem_->objective());
               utility > toBeat()) {
      std::vector<CellIndex> cells = pathTo(cell, parent);
      std::vector<CellIndex> sorted = cells;
      std::sort(sorted.begin(), sorted.end());
      if (std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end()) {
        found_->offer(path.so_far, [&] { return cells; });
      } else {
        best_walk_ = utility;
      }
    }
    if (over_ == Over::kSimple && problem_->goal()) return;  // a simple path ends there once
  }
  add(path, parent);
}

void RewardSearch::add(const PathPrefix& path, Id parent) {
  const auto [head, is_new] = heads_.try_emplace(key(path), kNone);
  if (!is_new && dominated(path, head->second)) return;
  findAvailable(path.cell);
  const CollectionBound& bound = problem_->bound();
  double priority = -path.so_far.cost;  // the front is found from its cheap end
  if (aim_ == Aim::kBest) {
    priority = bound.utility(path, available_, problem_->objective());
    if (priority <= toBeat()) return;
  } else if (!bound.mayExtendFront(path, available_, *found_)) {
    return;
  }
  const Id id = static_cast<Id>(labels_.size());
  labels_.push_back({path, parent, head->second, false});
  bits_.insert(bits_.end(), set_.begin(), set_.end());
  head->second = id;
  open_.emplace(priority, id);
}

bool RewardSearch::dominated(const PathPrefix& path, Id head) {
  const bool by_expected =
      aim_ == Aim::kBest && problem_->objective() == Objective::kExpectedReward;
  const auto asGood = [&](const PathPrefix& a, const PathPrefix& b) {
    return a.so_far.cost <= b.so_far.cost && a.traverse.sums.mud <= b.traverse.sums.mud &&
           a.traverse.sums.energy <= b.traverse.sums.energy &&
           (!by_expected || a.so_far.expected >= b.so_far.expected);
  };
  for (Id id = head; id != kNone; id = labels_[static_cast<std::size_t>(id)].same_key) {
    Label& other = labels_[static_cast<std::size_t>(id)];
    if (other.dominated || !sameKey(other, id, path)) continue;
    if (asGood(other.path, path)) return true;
    other.dominated = asGood(path, other.path);
  }
  return false;
}

bool RewardSearch::sameKey(const Label& label, Id id, const PathPrefix& path) const {
  const PathPrefix& other = label.path;
  const auto bits = bitsOf(id);
  return other.cell == path.cell && other.incoming == path.incoming &&
         other.traverse.stack == path.traverse.stack &&
         std::equal(bits.begin(), bits.end(), set_.begin());
}

std::uint64_t RewardSearch::key(const PathPrefix& path) const {
  std::uint64_t h = 0x9e3779b97f4a7c15U;
  const auto mix = [&h](std::uint64_t x) {
    h = (h ^ x) * 0xff51afd7ed558ccdU;
    h ^= h >> 32;
  };
  mix(static_cast<std::uint64_t>(path.cell));
  mix(static_cast<std::uint64_t>(path.incoming) << 32 | path.traverse.stack);
  for (const Word word : set_) mix(word);
  return h;
}

void RewardSearch::findAvailable(CellIndex from) {
  const Collectibles& collectibles = problem_->collectibles();
  if (over_ == Over::kWalks) {
    for (std::size_t k = 0; k < collectibles.size(); ++k) {
      available_[k] = visited(collectibles.items()[k].cell) ? 0 : 1;
    }
    return;
  }
  // A simple path may still go where cells that it has not visited lead.
  std::fill(available_.begin(), available_.end(), std::uint8_t{0});
  seen_ = set_;
  flood_.assign(1, from);
  const Lattice& lattice = problem_->lattice();
  while (!flood_.empty()) {
    const CellIndex u = flood_.back();
    flood_.pop_back();
    const std::uint32_t moves = lattice.moves(u);
    for (const Direction d : lattice.directions()) {
      if ((moves >> d & 1U) == 0) continue;
      const CellIndex v = lattice.neighbour(u, d);
      const int bit = bit_at_[static_cast<std::size_t>(v)];
      if (bit < 0 || has(seen_, bit)) continue;
      put(seen_, bit);
      const int item = collectibles.itemAt(v);
      if (item >= 0) available_[static_cast<std::size_t>(item)] = 1;
      if (v != problem_->goal()) flood_.push_back(v);  // nothing lies beyond the goal
    }
  }
}

bool RewardSearch::visited(CellIndex cell) const {
  return has(set_, bit_at_[static_cast<std::size_t>(cell)]);
}

std::vector<CellIndex> RewardSearch::pathTo(CellIndex last, Id parent) const {
  std::vector<CellIndex> path{last};
  for (Id id = parent; id != kNone; id = labels_[static_cast<std::size_t>(id)].parent) {
    path.push_back(labels_[static_cast<std::size_t>(id)].path.cell);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

std::span<const RewardSearch::Word> RewardSearch::bitsOf(Id id) const {
  return std::span(bits_).subspan(static_cast<std::size_t>(id) * words_, words_);
}

}  // namespace tautline::planning
