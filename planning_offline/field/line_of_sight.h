#pragma once

/// @file
/// Exact voxel walks (Amanatides and Woo, 1987) along straight lines. Not real-time safe: offline
/// only.

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// True if the straight line between two points meets the interior of no blocked cell. Touching
/// faces, edges or corners is free. Exact for cell centres and corners. Cells outside the grid do
/// not block. Points in cell units: (p_M − origin) / resolution. `blocked`: one byte a cell, 0 =
/// free.
[[nodiscard]] bool lineOfSight(const GridShape& shape, std::span<const std::uint8_t> blocked,
                               const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept;

}  // namespace tautline::planning
