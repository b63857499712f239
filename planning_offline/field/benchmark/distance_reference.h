#pragma once

/// @file
/// DynamicEDT3D (Lau, Sprunk, Burgard, 2013), what the distance field is timed against.

#include <cstdint>
#include <span>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Time of its first update [s], without setting its map up. `reach`: cells.
[[nodiscard]] double dynamicEdtSeconds(const GridShape& shape,
                                       std::span<const std::uint8_t> obstacles, int reach);

}  // namespace tautline::planning
