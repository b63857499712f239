#pragma once

/// @file
/// Which cells a tether that may touch obstacles reaches under limits: on its length, on the
/// elevation seen from the active anchor, on the number of contacts. Not real-time safe: offline
/// only.
///
/// The tether depends on the path flown, and there is no end of paths. A cell counts here by at
/// most three kinds of them: the shortest way on the lattice from where the vehicle takes off, the
/// shortest one through cells that a straight tether reaches, and the shortest one through those
/// whose straight tether is within the limits, from the nearest of them. Limits hold in every state
/// of the way, and none touches a forbidden surface (VoxelMap::no_contact). So whatever counts can
/// be flown, and other paths may reach more: an inner bound. The outer bounds are beside it.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "planning_offline/field/reach.h"
#include "planning_offline/map/lattice.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/progress.h"
#include "planning_offline/risk/risk_params.h"

namespace tautline::planning {

/// Cells that are reached for certain, and how many can be at most.
struct ReachBounds {
  std::size_t reached{0};
  std::size_t at_most{0};
};

struct TetherReach {
  /// By length_max and by both limits. No tether is shorter than the straight distance from the
  /// reel: that is the outer bound.
  ReachBounds within_length;
  ReachBounds within_limits;
  std::size_t within_elevation{0};  ///< By elevation_min alone; no outer bound is known.
  /// [k]: by at most k contacts, k = 0 … what the cell that needs most needs, or contacts_max. The
  /// outer bound is that of contact_bound.h: in the plane good, in space good for k = 0 only.
  std::vector<ReachBounds> with_at_most;
  /// One a cell: the most contacts in a state of the way, of that way which needs fewer; −1 where
  /// no way leads, or none off the forbidden surfaces.
  std::vector<std::int32_t> contacts;
  bool complete{false};  ///< False if cancelled: the counts then mean nothing.
};

/// `reach` is that of the lattice's free cells; `map` has a reel. The tether's obstacles are the
/// map's occupied cells, whatever clearance `reach` was made with.
[[nodiscard]] TetherReach tetherReach(const std::shared_ptr<const VoxelMap>& map,
                                      const Lattice& lattice, const ReachMap& reach,
                                      const TetherLimits& limits, const Progress& progress);

}  // namespace tautline::planning
