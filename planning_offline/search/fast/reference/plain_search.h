#pragma once

/// @file
/// The directional search as a textbook has it, on the same whole units as the fast one: what tests
/// hold that equal to, and benchmarks measure it against. Every (cell, direction) is a state of its
/// own. Not real-time safe: offline only.

#include <cstdint>
#include <limits>
#include <vector>

#include "planning_offline/map/lattice.h"
#include "planning_offline/search/fast/unit_costs.h"

namespace tautline::planning {

/// Least cost [units] of walks from the start to cell i that arrive by direction d, at
/// [i · kDirections + d].
struct PlainLabels {
  static constexpr std::uint32_t kUnreached = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> label;

  [[nodiscard]] std::uint32_t of(CellIndex cell, Direction d) const {
    return label[static_cast<std::size_t>(cell) * kDirections + static_cast<std::size_t>(d)];
  }
  /// Zero at the start is not looked at: it is the least of the arrivals.
  [[nodiscard]] std::uint32_t least(CellIndex cell) const;
};

/// std::priority_queue, entries that have become stale are skipped.
[[nodiscard]] PlainLabels heapSearch(const Lattice& lattice, const UnitCosts& units,
                                     const std::vector<double>& locale, CellIndex start);

/// Circular buckets as wide as those of the fast search, unordered inside.
[[nodiscard]] PlainLabels bucketSearch(const Lattice& lattice, const UnitCosts& units,
                                       const std::vector<double>& locale, CellIndex start);

}  // namespace tautline::planning
