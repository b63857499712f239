#pragma once

/// @file
/// Which cells are obstacles: the one answer that all fields share. Not real-time safe: offline
/// only.

#include <cstdint>
#include <vector>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// One byte a cell, 1 = obstacle: occupied cells, and unknown ones if asked.
[[nodiscard]] std::vector<std::uint8_t> obstacleCells(const VoxelMap& map,
                                                      bool unknown_is_obstacle);

}  // namespace tautline::planning
