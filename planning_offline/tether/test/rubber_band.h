#pragma once

/// @file
/// Independent oracle for the planar string: the path flown, tightened like a rubber band. Wherever
/// the band bends, the bend is replaced by the convex hull of the obstacle corners in the triangle
/// of the bend and its neighbours, until nothing changes. What is left is locally shortest, and in
/// the plane there is only one such curve in a homotopy class. Shares no notion of anchor, sweep or
/// release with the code under test.

#include <cstdint>
#include <vector>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Point (u, v) = (z, x) in 1/1024 cells.
struct BandPoint {
  std::int64_t u{0};
  std::int64_t v{0};
  friend bool operator==(const BandPoint&, const BandPoint&) = default;
};

/// The tight band from the first to the last point of a path that goes through no obstacle; both
/// ends included.
[[nodiscard]] std::vector<BandPoint> tightened(const VoxelMap& map, std::vector<BandPoint> path);

/// True if the straight line from p to q stays out of the inside of all obstacles and does not slip
/// between two of them that touch at a corner.
[[nodiscard]] bool passable(const VoxelMap& map, const BandPoint& p, const BandPoint& q);

}  // namespace tautline::planning
