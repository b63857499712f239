#pragma once

/// @file
/// The known part of a path that may go on: its end, what of its past the future depends on, and
/// what ending here is worth. Not real-time safe: offline only.

#include "planning_offline/map/lattice.h"
#include "planning_offline/planner/traverse.h"
#include "planning_offline/planner/utility/candidates.h"

namespace tautline::planning {

struct PathPrefix {
  CellIndex cell{kNoCell};
  Direction incoming{kNoDirection};
  TraverseState traverse;
  Candidate so_far;       ///< Of the path that ends here; its cost is infinite beyond a limit.
  double leg_start{0.0};  ///< Cost at the last collectible (taken or not) or at the start.
};

}  // namespace tautline::planning
