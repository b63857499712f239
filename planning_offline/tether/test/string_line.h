#pragma once

/// @file
/// What a string must be, whatever made it: judged by the line it takes. Independent of the code
/// under test. Points in M [m].

#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Reel, contacts, end.
[[nodiscard]] std::vector<Eigen::Vector3d> stringLine(const Eigen::Vector3d& reel,
                                                      const std::vector<Eigen::Vector3d>& contacts,
                                                      const Eigen::Vector3d& end);

/// How deep a point is inside the union of the occupied cells, by the largest component of the way
/// out; up to one cell [cells].
[[nodiscard]] double depth(const VoxelMap& map, const Eigen::Vector3d& p_M);

/// How deep the line goes into the union of the occupied cells [cells]. Samples are 0.04 cells
/// apart.
[[nodiscard]] double deepest(const VoxelMap& map, const std::vector<Eigen::Vector3d>& line);

/// How often a closed line, the last point joined to the first, goes round the axis through
/// `centre` along one of the map's axes.
[[nodiscard]] int windings(const std::vector<Eigen::Vector3d>& closed, int axis,
                           const Eigen::Vector3d& centre);

}  // namespace tautline::planning
