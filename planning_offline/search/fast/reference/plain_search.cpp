#include "planning_offline/search/fast/reference/plain_search.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <queue>
#include <utility>

namespace tautline::planning {
namespace {

using State = std::uint32_t;
using Entry = std::pair<std::uint32_t, State>;  // label, state

class HeapQueue {
 public:
  void push(Entry entry) { heap_.push(entry); }
  bool pop(Entry& entry) {
    if (heap_.empty()) return false;
    entry = heap_.top();
    heap_.pop();
    return true;
  }

 private:
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> heap_;
};

class CircularQueue {
 public:
  explicit CircularQueue(const UnitCosts& units)
      : shift_(units.shift()), ring_(std::bit_ceil((units.reach() >> units.shift()) + 2)) {}

  void push(Entry entry) {
    ring_[(entry.first >> shift_) & (ring_.size() - 1)].push_back(entry);
    ++size_;
  }
  bool pop(Entry& entry) {
    if (size_ == 0) return false;
    while (next_ == ring_[bucket_].size()) {
      ring_[bucket_].clear();
      next_ = 0;
      bucket_ = (bucket_ + 1) & (ring_.size() - 1);
    }
    entry = ring_[bucket_][next_++];
    --size_;
    return true;
  }

 private:
  int shift_;
  std::vector<std::vector<Entry>> ring_;
  std::size_t bucket_{0};
  std::size_t next_{0};
  std::size_t size_{0};
};

template <class Queue>
PlainLabels search(const Lattice& lattice, const UnitCosts& units,
                   const std::vector<double>& locale_cost, CellIndex start, Queue queue) {
  std::vector<std::uint32_t> locale;
  for (const double cost : locale_cost) locale.push_back(units.locale(cost));
  PlainLabels labels;
  labels.label.assign(locale.size() * kDirections, PlainLabels::kUnreached);

  const auto expand = [&](CellIndex u, Direction incoming, std::uint32_t cost) {
    const auto& turn = units.turn[static_cast<std::size_t>(incoming)];
    const std::uint32_t from = locale[static_cast<std::size_t>(u)];
    for (std::uint32_t moves = lattice.moves(u); moves != 0; moves &= moves - 1) {
      const Direction d = std::countr_zero(moves);
      const CellIndex v = lattice.neighbour(u, d);
      const std::uint32_t to = locale[static_cast<std::size_t>(v)];
      if (to == UnitCosts::kForbidden) continue;
      std::uint32_t next = cost + turn[static_cast<std::size_t>(d)] + units.step(d, from, to);
      if (units.hasAccess()) next += units.access(u, v);
      const State state = static_cast<State>(v) * kDirections + static_cast<State>(d);
      if (next >= labels.label[state]) continue;
      labels.label[state] = next;
      queue.push({next, state});
    }
  };
  expand(start, kNoDirection, 0);
  for (Entry entry; queue.pop(entry);) {
    const auto [cost, state] = entry;
    if (cost != labels.label[state]) continue;
    expand(static_cast<CellIndex>(state / kDirections), static_cast<Direction>(state % kDirections),
           cost);
  }
  return labels;
}

}  // namespace

std::uint32_t PlainLabels::least(CellIndex cell) const {
  const auto first = label.begin() + std::ptrdiff_t{cell} * kDirections;
  return *std::min_element(first, first + kDirections);
}

PlainLabels heapSearch(const Lattice& lattice, const UnitCosts& units,
                       const std::vector<double>& locale, CellIndex start) {
  return search(lattice, units, locale, start, HeapQueue());
}

PlainLabels bucketSearch(const Lattice& lattice, const UnitCosts& units,
                         const std::vector<double>& locale, CellIndex start) {
  return search(lattice, units, locale, start, CircularQueue(units));
}

}  // namespace tautline::planning
