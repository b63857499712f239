#pragma once

/// @file
/// Where a reel may stand: what is inside an obstacle and what only on its surface. Not real-time
/// safe: offline only.

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// The farthest that a string goes from the map's origin along an axis [cells]: as far as the
/// integer arithmetic of the planar string goes.
inline constexpr double kFarthest = 500'000.0;

/// True if all cells that a point touches are occupied: on the surface of an obstacle it is
/// outside. In cells from the map's origin, within ±kFarthest; may be off the map, which has
/// nothing there.
[[nodiscard]] bool insideObstacle(const VoxelMap& map, const Eigen::Vector3d& p_cells);

struct ReelRule {
  double farthest{kFarthest};  ///< From the map's origin along an axis [cells]; at most kFarthest.
  /// What the tether keeps out of, one byte a cell, 0 = free; empty: the occupied cells.
  std::span<const std::uint8_t> blocked{};
};

/// The reel, in M [m], if it may stand there; else throws InputError: it is too far away, not
/// finite, or inside an obstacle. It may stand on an obstacle's surface.
[[nodiscard]] const Eigen::Vector3d& checkedReel(const VoxelMap& map, const Eigen::Vector3d& reel,
                                                 const ReelRule& rule = {});

}  // namespace tautline::planning
