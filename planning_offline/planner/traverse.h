#pragma once

/// @file
/// The fold that traverse elements are: what a path carries along (contact stack, mud, energy), and
/// what each step costs with it, in O(1). Hard limits of the tether are infinite costs. Not
/// real-time safe: offline only.

#include <optional>

#include "planning_offline/map/lattice.h"
#include "planning_offline/planner/contact_bound.h"
#include "planning_offline/planner/flat_index.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning {

struct TraverseState {
  StackId stack{kStraight};
  Accumulators sums;
};

/// For one model, which must outlive it. Moves of the string are remembered: most of
/// a search's steps repeat one. Not thread-safe.
class Traverse {
 public:
  explicit Traverse(const RiskModel& risk);

  /// Any element or limit looks at the whole path.
  [[nodiscard]] bool active() const noexcept { return tethered_ || summing(); }
  [[nodiscard]] bool summing() const noexcept { return muddy_ || draining_; }

  [[nodiscard]] TraverseState start(CellIndex cell) const;

  /// Cost of a path's first state, all elements.
  [[nodiscard]] double startCost(CellIndex cell);

  /// Cost of the step from u, entered by `incoming`, to v in direction d, all elements; `state`,
  /// u's, becomes v's. Infinite (and `state` worthless) beyond a limit.
  [[nodiscard]] double step(TraverseState& state, CellIndex u, Direction incoming, Direction d,
                            CellIndex v);

  /// Limits of the tether that made a cost infinite so far.
  [[nodiscard]] const BrokenLimits& refused() const noexcept { return refused_; }

  /// Lower bound of what tether elements cost for the step in direction d to v, whatever the path:
  /// the string is no shorter than a straight line and has the contacts of ContactBound.
  [[nodiscard]] double tetherBound(CellIndex v, Direction d);

 private:
  /// −log(1 − r) of the traverse elements in a cell; infinite beyond a limit.
  [[nodiscard]] double stateCost(const TraverseState& state, CellIndex cell);
  [[nodiscard]] double tetherCost(StackId stack, CellIndex cell);
  /// No string to the cell costs less there.
  [[nodiscard]] double leastTetherCost(CellIndex cell);
  [[nodiscard]] StackId moveString(StackId stack, CellIndex u, Direction d, CellIndex v);

  const RiskModel* risk_;
  bool rate_;
  bool tethered_;
  bool muddy_;
  bool draining_;
  BrokenLimits refused_;
  FlatIndex moves_;
  std::optional<ContactBound> contact_bound_;  // made when first asked for
};

}  // namespace tautline::planning
