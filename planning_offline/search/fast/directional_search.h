#pragma once

/// @file
/// The fast directional search: least cost of walks to all cells and from all directions, exact in
/// whole units, label-equal to a plain one (docs/fast_search.md says how and why). Not real-time
/// safe: offline only.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "planning_offline/map/lattice.h"
#include "planning_offline/progress.h"
#include "planning_offline/search/fast/directional_labels.h"
#include "planning_offline/search/fast/free_cells.h"
#include "planning_offline/search/fast/large_array.h"
#include "planning_offline/search/fast/unit_costs.h"

namespace tautline::planning {

class DirectionalSearch {
 public:
  /// `locale`: cost of each cell of the lattice, the one that `units` was made from; only read
  /// here. The lattice must outlive the search. Start free, with a finite locale.
  DirectionalSearch(const Lattice& lattice, UnitCosts units, const std::vector<double>& locale,
                    CellIndex start);

  /// All goals, or until cancelled.
  void run(const Progress& progress);

  [[nodiscard]] const UnitCosts& units() const noexcept { return units_; }

  /// Least cost of a walk from the start [units]; zero at the start, empty if there is none or the
  /// search was cancelled before it was sure.
  [[nodiscard]] std::optional<std::uint64_t> least(CellIndex cell) const;

  /// That of those arriving by direction d. Labels that no better walk can come from may be missing
  /// or too large; they are so by UnitCosts::dominated.
  [[nodiscard]] std::optional<std::uint64_t> label(CellIndex cell, Direction d) const;

  /// Direction by which the walk of least() arrives; kNoDirection at the start. Only where there is
  /// one.
  [[nodiscard]] Direction bestIncoming(CellIndex cell) const;

  /// Direction by which the walk of label(cell, d) entered the cell before, kNoDirection if that is
  /// the start; the smallest of equals. Only for labels that a walk of least() goes through.
  [[nodiscard]] Direction incomingBefore(CellIndex cell, Direction d) const;

  /// The walk of least(), start first; empty if there is none. Of equal ones the one whose last
  /// steps have the smallest directions.
  [[nodiscard]] std::vector<CellIndex> pathTo(CellIndex cell) const;

  [[nodiscard]] bool complete() const noexcept { return complete_; }
  [[nodiscard]] std::size_t expanded() const noexcept { return expanded_; }  ///< Cells, not labels.
  /// Memory held at most while it ran, without the lattice.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  [[nodiscard]] const CellLabels* labelsOf(CellIndex cell) const noexcept;
  [[nodiscard]] std::uint32_t stepUnits(CellIndex from, Direction d) const;

  const Lattice* lattice_;
  UnitCosts units_;
  CellIndex start_;
  FreeCells numbers_;
  LargeArray<CellLabels> labels_;
  LargeArray<Gate> gates_;  ///< One before the first and one after the last, so that asking for
                            ///< neighbours that are not there does no harm.
  BucketQueue queue_;
  std::size_t queue_bytes_{0};
  std::size_t expanded_{0};
  std::uint64_t final_below_{0};  ///< Labels from here on may still get better.
  bool complete_{false};
};

}  // namespace tautline::planning
