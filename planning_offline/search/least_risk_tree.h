#pragma once

/// @file
/// Least-cost walks from the start to every cell over directional components (the dissertation's
/// Algorithm 2): the state is cell × incoming direction, the costs are those of locale and action
/// elements. Not real-time safe: offline only.

#include <memory>
#include <optional>
#include <vector>

#include "planning_offline/map/lattice.h"
#include "planning_offline/progress.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning {

/// A directional component of a walk: a cell and the direction it was entered by, kNoDirection for
/// the start before the first step.
struct WalkEnd {
  CellIndex cell{kNoCell};
  Direction incoming{kNoDirection};
  friend bool operator==(const WalkEnd&, const WalkEnd&) = default;
};

/// What the searches found. Costs include the start's own (RiskModel::startCost()).
///
/// The walks to all cells are a tree over components, not over cells: two walks that come through
/// the same cell share their beginning only if they entered it by the same direction. `lastOf()`
/// and `before()` are that tree; ties are broken the same way every time.
class LeastRiskTree {
 public:
  virtual ~LeastRiskTree() = default;

  /// Cost −log(1 − risk) of the best walk to a cell; infinite if there is none.
  [[nodiscard]] virtual double costTo(CellIndex cell) const = 0;

  /// The component that this walk ends in; nothing if there is none.
  [[nodiscard]] virtual std::optional<WalkEnd> lastOf(CellIndex cell) const = 0;

  /// The component before one that such a walk goes through and that is not the start's: the same
  /// for all of them.
  [[nodiscard]] virtual WalkEnd before(const WalkEnd& end) const = 0;

  /// The walk, start first; empty if there is none.
  [[nodiscard]] std::vector<CellIndex> pathTo(CellIndex cell) const;

  /// How far costTo() may be above the true least cost; 0 for exact arithmetic.
  [[nodiscard]] virtual double costError() const = 0;

  [[nodiscard]] virtual std::size_t expanded() const = 0;
  [[nodiscard]] virtual bool complete() const = 0;  ///< False if cancelled.
};

/// Simple and exact: a binary heap of (cell, direction) labels in double. The yardstick of the fast
/// one.
[[nodiscard]] std::unique_ptr<LeastRiskTree> leastRiskTreeReference(const Lattice& lattice,
                                                                    const RiskModel& risk,
                                                                    CellIndex start,
                                                                    const Progress& progress);

/// The same in whole units for large maps (docs/fast_search.md). Costs that do not fit those are
/// left to the reference. One thread, whatever `threads` allows; 0 = all cores.
[[nodiscard]] std::unique_ptr<LeastRiskTree> leastRiskTreeFast(const Lattice& lattice,
                                                               const RiskModel& risk,
                                                               CellIndex start, int threads,
                                                               const Progress& progress);

/// The one to use; lattice and risk must outlive the tree of any of the three. Exact arithmetic up
/// to a few hundred thousand components, the fast one above.
[[nodiscard]] std::unique_ptr<LeastRiskTree> leastRiskTree(const Lattice& lattice,
                                                           const RiskModel& risk, CellIndex start,
                                                           int threads, const Progress& progress);

}  // namespace tautline::planning
