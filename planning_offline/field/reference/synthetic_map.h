#pragma once

/// @file
/// Maps made from a seed, for tests and benchmarks.

#include <cstdint>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Cells with independent random states: occupied and unknown with the given probabilities.
[[nodiscard]] VoxelMap randomMap(const GridShape& shape, double occupied, double unknown,
                                 std::uint32_t seed);

/// A building: a wall every 25 cells along x and z with doorways, boxes in the rooms, a floor and a
/// ceiling. Cells of 0.1 m.
[[nodiscard]] VoxelMap roomsMap(const GridShape& shape, std::uint32_t seed);

}  // namespace tautline::planning
