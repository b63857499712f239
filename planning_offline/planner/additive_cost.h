#pragma once

/// @file
/// The conventional, state-dependent view of risk that the dissertation argues against: a path's
/// risk is the plain sum of what its cells have, whatever the way there. Not real-time safe:
/// offline only.

#include <functional>
#include <optional>
#include <vector>

#include "planning_offline/map/lattice.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning {

enum class AdditiveWeights : std::uint8_t {
  kPlain,       ///< Σ of the locale risks.
  kNormalized,  ///< Σ of the locale risks, each over its largest value in a free cell: all weigh
                ///< the same.
};

/// Additive cost of each cell; infinite where the cell is not free or certain failure.
[[nodiscard]] std::vector<double> additiveCosts(const Lattice& lattice, const RiskModel& risk,
                                                AdditiveWeights weights);

/// Paths of least Σ cost over their cells, the start included, to all cells (Dijkstra's search).
struct AdditivePaths {
  std::vector<double> cost;       ///< One a cell, infinite where no path leads.
  std::vector<CellIndex> before;  ///< Predecessor, kNoCell at the start and where no path leads.
  std::int64_t expanded{0};
  bool complete{true};  ///< False if `stop` ended it.

  /// Start first; empty if no path leads there or, beyond the goal of the search, none is known.
  [[nodiscard]] std::vector<CellIndex> pathTo(CellIndex cell) const;
};
/// Ties: fewer steps, then the lower cells. `stop` is asked at each expansion. With `goal` the
/// search ends there: paths to other cells may be missing or not the least.
[[nodiscard]] AdditivePaths additivePaths(const Lattice& lattice,
                                          const std::vector<double>& cell_cost, CellIndex start,
                                          const std::function<bool()>& stop,
                                          std::optional<CellIndex> goal = std::nullopt);

}  // namespace tautline::planning
