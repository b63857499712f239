#pragma once

/// @file
/// What a tether reaches from its reel (dissertation, section "Reachable Space Reduction via Ray
/// Casting"). Not real-time safe: offline only.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/field/tether_limits.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/progress.h"

namespace tautline::planning {

struct ReachOptions {
  TetherLimits limits{};         ///< Length and elevation: what is within them is counted.
  double tether_clearance{0.0};  ///< The tether also keeps out of cells whose centre is nearer to
                                 ///< an occupied cell than this [m]; the published figure inflates
                                 ///< obstacles by one cell, and the tether by them.
  int threads{0};                ///< 0 = all cores.
};

/// What is reached with contacts under limits needs the taut string: planner/tether_reach.h.
struct ReachMap {
  std::vector<std::uint8_t> straight;  ///< One a cell: free, and the straight tether from the reel
                                       ///< to its centre meets no interior of an obstacle cell
                                       ///< (touching faces is allowed), whatever its length.
  std::vector<std::uint8_t> with_contacts;  ///< Free and connected over faces to `take_off`.
  CellIndex take_off{kNoCell};  ///< Where the vehicle takes off: the cell nearest to the reel that
                                ///< a straight tether reaches; kNoCell if it reaches none.
  std::size_t free{0};
  std::size_t straight_count{0};
  std::size_t straight_within_length{0};     ///< Of these, by the length alone,
  std::size_t straight_within_elevation{0};  ///< by the elevation alone,
  std::size_t straight_within_limits{0};     ///< by both.
  std::size_t with_contacts_count{0};
};

/// `free` as freeSpace() gives it; obstacles for the tether are the map's occupied cells. The reel
/// [m, M] may lie outside the map. Throws InputError if it is inside an obstacle or its clearance
/// (checkedReel()), or if it or the map's end is farther than kSightFarthest cells from the origin.
/// When cancelled, cells that were not looked at yet count as not reached.
[[nodiscard]] ReachMap computeReach(const VoxelMap& map, std::span<const std::uint8_t> free,
                                    const Eigen::Vector3d& reel, const ReachOptions& options,
                                    const Progress& progress);

}  // namespace tautline::planning
