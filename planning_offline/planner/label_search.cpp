#include "planning_offline/planner/label_search.h"

#include <algorithm>
#include <utility>

#include "common/error.h"

namespace tautline::planning {
namespace {

constexpr int kDirectionBits = 5;
constexpr std::uint16_t kDirectionMask = (1U << kDirectionBits) - 1;
/// A path without a past: each remembered direction is kNoDirection.
constexpr std::uint16_t kNoHistory =
    kNoDirection << 2 * kDirectionBits | kNoDirection << kDirectionBits | kNoDirection;

Direction latest(std::uint16_t history) { return history & kDirectionMask; }

std::uint16_t extend(std::uint16_t history, Direction d) {
  constexpr unsigned kThree = (1U << 3 * kDirectionBits) - 1;
  const unsigned shifted = static_cast<unsigned>(history) << kDirectionBits;
  return static_cast<std::uint16_t>((shifted | static_cast<unsigned>(d)) & kThree);
}

bool dominates(double cost, const Accumulators& sums, double other_cost,
               const Accumulators& other) {
  return cost <= other_cost && sums.mud <= other.mud && sums.energy <= other.energy;
}

}  // namespace

LabelSearch::LabelSearch(const Lattice& lattice, Traverse& traverse, CellIndex start,
                         LabelSearchSettings settings)
    : lattice_(&lattice),
      traverse_(&traverse),
      settings_(settings),
      best_(lattice.shape().size(), kNoLabel) {
  TAUTLINE_CHECK(settings.lookback >= 2 && settings.lookback <= 4);
  const TraverseState state = traverse.start(start);
  offer({traverse.startCost(start), start, kNoLabel, kNoLabel, state.stack, 0, kNoHistory,
         Fate::kOpen},
        state.sums);
}

void LabelSearch::run(Budget& budget, const char* what) {
  for (dropStale(); !queue_.empty(); dropStale()) {
    if (budget.spent(labels(), what)) return;
    const Index i = queue_.top().label;
    queue_.pop();
    labels_[i].fate = Fate::kClosed;
    Index& best = best_[static_cast<std::size_t>(labels_[i].cell)];
    if (best == kNoLabel || labels_[i].cost < labels_[best].cost) best = i;
    ++expanded_;
    if (labels_[i].cell == settings_.goal) return;
    expand(i);
  }
}

bool LabelSearch::stale(const Entry& entry) const {
  const Label& label = labels_[entry.label];
  return label.fate != Fate::kOpen || label.cost != entry.cost || label.steps != entry.steps;
}

void LabelSearch::dropStale() {
  while (!queue_.empty() && stale(queue_.top())) queue_.pop();
}

void LabelSearch::expand(Index i) {
  const Label from = labels_[i];  // a copy: labels move when one is added
  const Accumulators sums = sumsOf(i);
  const Direction incoming = latest(from.history);
  const std::uint32_t moves = lattice_->moves(from.cell);
  for (const Direction d : lattice_->directions()) {
    if ((moves >> d & 1U) == 0) continue;
    const CellIndex v = lattice_->neighbour(from.cell, d);
    TraverseState state{from.stack, sums};
    const double cost = from.cost + traverse_->step(state, from.cell, incoming, d, v);
    offer({cost, v, i, kNoLabel, state.stack, from.steps + 1, extend(from.history, d), Fate::kOpen},
          state.sums);
  }
}

void LabelSearch::offer(const Label& label, const Accumulators& sums) {
  if (!(label.cost <= settings_.cost_max) || !(label.cost < kInfiniteCost)) return;
  double estimate = label.cost;
  if (settings_.to_go != nullptr) {
    estimate += settings_.to_go->cost(label.cell, latest(label.history));
    if (!(estimate <= settings_.cost_max) || !(estimate < kInfiniteCost)) return;
  }
  const Index i = place(label, sums);
  if (i != kNoLabel) queue_.push({estimate, label.cost, label.steps, i});
}

FlatIndex::Key LabelSearch::keyOf(const Label& label) const {
  const auto cell = static_cast<FlatIndex::Key>(label.cell);  // 31 bits
  if (settings_.stacks) {
    return static_cast<FlatIndex::Key>(label.stack) << 36 | cell << kDirectionBits |
           static_cast<FlatIndex::Key>(latest(label.history));
  }
  const unsigned bits = static_cast<unsigned>(settings_.lookback - 1) * kDirectionBits;
  return cell << 3 * kDirectionBits | (label.history & ((1U << bits) - 1));
}

LabelSearch::Index LabelSearch::place(const Label& label, const Accumulators& sums) {
  Index& head = states_[keyOf(label)];
  if (settings_.stacks && traverse_->summing()) return placePareto(head, label, sums);
  return placeCheapest(head, label, sums);
}

LabelSearch::Index LabelSearch::placeCheapest(Index& head, const Label& label,
                                              const Accumulators& sums) {
  if (head == kNoLabel) return head = append(label, sums);
  Label& old = labels_[head];
  if (std::pair(old.cost, old.steps) <= std::pair(label.cost, label.steps)) return kNoLabel;
  // A closed label has children that point to it: only open ones may be written over. (One that
  // is closed improves by rounding only, or where the carried state makes the cost-to-go
  // inconsistent.)
  if (old.fate == Fate::kClosed) return head = append(label, sums);
  old = label;
  if (!sums_.empty()) sums_[head] = sums;
  return head;
}

LabelSearch::Index LabelSearch::placePareto(Index& head, const Label& label,
                                            const Accumulators& sums) {
  for (Index i = head; i != kNoLabel; i = labels_[i].sibling) {
    if (dominates(labels_[i].cost, sums_[i], label.cost, sums)) return kNoLabel;
  }
  for (Index* link = &head; *link != kNoLabel;) {
    Label& other = labels_[*link];
    if (dominates(label.cost, sums, other.cost, sums_[*link])) {
      if (other.fate == Fate::kOpen) other.fate = Fate::kDominated;
      *link = other.sibling;
    } else {
      link = &other.sibling;
    }
  }
  Label first = label;
  first.sibling = head;
  return head = append(first, sums);
}

LabelSearch::Index LabelSearch::append(const Label& label, const Accumulators& sums) {
  const auto i = static_cast<Index>(labels_.size());
  labels_.push_back(label);
  if (traverse_->summing()) sums_.push_back(sums);
  return i;
}

double LabelSearch::costTo(CellIndex cell) const {
  const Index i = best_[static_cast<std::size_t>(cell)];
  return i == kNoLabel ? kInfiniteCost : labels_[i].cost;
}

std::vector<CellIndex> LabelSearch::pathTo(CellIndex cell) const {
  return pathOf(best_[static_cast<std::size_t>(cell)]);
}

double LabelSearch::openCost() const {
  return queue_.empty() ? kInfiniteCost : queue_.top().estimate;
}

std::vector<CellIndex> LabelSearch::openPath() const {
  return queue_.empty() ? std::vector<CellIndex>{} : pathOf(queue_.top().label);
}

std::vector<CellIndex> LabelSearch::pathOf(Index i) const {
  std::vector<CellIndex> path;
  for (; i != kNoLabel; i = labels_[i].parent) path.push_back(labels_[i].cell);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace tautline::planning
