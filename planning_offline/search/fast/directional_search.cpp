#include "planning_offline/search/fast/directional_search.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/error.h"
#include "planning_offline/search/fast/bucket_expansion.h"

namespace tautline::planning {
namespace {

std::size_t at(Direction d) { return static_cast<std::size_t>(d); }

}  // namespace

DirectionalSearch::DirectionalSearch(const Lattice& lattice, UnitCosts units,
                                     const std::vector<double>& locale, CellIndex start)
    : lattice_(&lattice),
      units_(std::move(units)),
      start_(start),
      numbers_(lattice),
      labels_(lattice.freeCount()),
      gates_(lattice.freeCount() + 2),
      queue_((units_.reach() >> units_.shift()) + 1) {
  TAUTLINE_CHECK(lattice.free(start));
  Gate* gate = gates_.data() + 1;
  const auto free = lattice.freeCells();
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (free[i] != 0) (gate++)->locale = static_cast<std::uint16_t>(units_.locale(locale[i]));
  }
}

void DirectionalSearch::run(const Progress& progress) {
  const BucketExpansion search{*lattice_,         units_, numbers_, labels_.data(),
                               gates_.data() + 1, queue_};
  expandStart(search, start_, gates_[numbers_[start_].number + 1].locale);
  std::uint32_t bucket = 0;
  for (; !queue_.empty() && !progress.cancelled(); ++bucket) {
    if (queue_.at(bucket).empty()) continue;
    expanded_ += expandBucket(search, bucket);
    queue_.release(bucket);
    progress.report("least risk to all cells", -1.0);
  }
  complete_ = queue_.empty();
  final_below_ = complete_ ? std::numeric_limits<std::uint64_t>::max()
                           : std::uint64_t{bucket} << units_.shift();
  queue_bytes_ = queue_.bytes();
}

const CellLabels* DirectionalSearch::labelsOf(CellIndex cell) const noexcept {
  const FreeCells::Number n = numbers_[cell];
  if (n.free == 0) return nullptr;
  const CellLabels& labels = labels_[n.number];
  return labels.reached() ? &labels : nullptr;
}

std::optional<std::uint64_t> DirectionalSearch::least(CellIndex cell) const {
  if (cell == start_) return 0;
  const CellLabels* labels = labelsOf(cell);
  return labels == nullptr ? std::nullopt : label(cell, labels->best());
}

std::optional<std::uint64_t> DirectionalSearch::label(CellIndex cell, Direction d) const {
  const CellLabels* labels = labelsOf(cell);
  if (labels == nullptr || labels->offset[at(d)] == CellLabels::kNone) return std::nullopt;
  const std::uint64_t cost =
      (std::uint64_t{labels->bucket} << units_.shift()) + labels->offset[at(d)];
  return cost < final_below_ ? std::optional(cost) : std::nullopt;
}

std::uint32_t DirectionalSearch::stepUnits(CellIndex from, Direction d) const {
  const CellIndex to = lattice_->neighbour(from, d);
  const std::uint32_t step = units_.step(d, gates_[numbers_[from].number + 1].locale,
                                         gates_[numbers_[to].number + 1].locale);
  return units_.hasAccess() ? step + units_.access(from, to) : step;
}

Direction DirectionalSearch::bestIncoming(CellIndex cell) const {
  return cell == start_ ? kNoDirection : labelsOf(cell)->best();
}

Direction DirectionalSearch::incomingBefore(CellIndex cell, Direction d) const {
  const CellIndex from = lattice_->neighbour(cell, opposite(d));
  const std::uint64_t before = *label(cell, d) - stepUnits(from, d);
  if (from == start_ && before == units_.turn[kNoDirection][at(d)]) return kNoDirection;
  if (const CellLabels* labels = labelsOf(from)) {
    const std::uint64_t base = std::uint64_t{labels->bucket} << units_.shift();
    for (const Direction p : lattice_->directions()) {
      const std::uint16_t offset = labels->offset[at(p)];
      const std::uint64_t cost = base + offset;
      if (offset != CellLabels::kNone && cost < final_below_ &&
          cost + units_.turn[at(p)][at(d)] == before) {
        return p;
      }
    }
  }
  constexpr bool kLabelHasAPredecessor = false;
  TAUTLINE_CHECK(kLabelHasAPredecessor);
  return kNoDirection;
}

std::vector<CellIndex> DirectionalSearch::pathTo(CellIndex cell) const {
  if (!least(cell)) return {};
  std::vector<CellIndex> path{cell};
  for (Direction d = bestIncoming(cell); d != kNoDirection;) {
    const CellIndex from = lattice_->neighbour(path.back(), opposite(d));
    d = incomingBefore(path.back(), d);
    path.push_back(from);
  }
  std::reverse(path.begin(), path.end());
  return path;
}

std::size_t DirectionalSearch::bytes() const noexcept {
  return numbers_.bytes() + labels_.bytes() + gates_.bytes() + queue_bytes_;
}

}  // namespace tautline::planning
