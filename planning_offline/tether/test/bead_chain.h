#pragma once

/// @file
/// Independent check that a string is as short as it gets: a chain of beads laid along it is
/// shortened by small moves of a few beads at a time, each tested against the cells by sampled
/// lines. Slow; shares no notion of edge, anchor, sweep or release with the code under test. It may
/// jam, so it says when a string is too long, not how short it should be.

#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Length [m] after a line of points [M, m] outside all obstacles was pulled at both ends.
[[nodiscard]] double pulledTight(const VoxelMap& map, const std::vector<Eigen::Vector3d>& line);

}  // namespace tautline::planning
