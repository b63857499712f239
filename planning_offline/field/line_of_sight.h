#pragma once

/// @file
/// Exact voxel walks (Amanatides and Woo, 1987) along straight lines. Not real-time safe: offline
/// only.

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Points of a line are rounded to this part of a cell; from there on all is exact integer
/// arithmetic. Centres and corners of cells are kept as they are.
inline constexpr double kSightUnit = 1.0 / 65536.0;

/// Largest coordinate of a line's end, either sign [cells].
inline constexpr double kSightFarthest = 16384.0;

/// True if the straight line between two points meets the interior of no blocked cell. Touching
/// faces, edges or corners is free, also with blocked cells on all sides of the line. Cells outside
/// the grid do not block. Points in cell units: (p_M − origin) / resolution, components within
/// ±kSightFarthest. `blocked`: one byte a cell, 0 = free.
[[nodiscard]] bool lineOfSight(const GridShape& shape, std::span<const std::uint8_t> blocked,
                               const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept;

/// True if the straight line meets no interior of a solid, all blocked cells taken as one: unlike
/// for lineOfSight(), a line between two blocked cells is inside, one along the outer face of a
/// block is free. For ways that something real goes. Arguments as there; a line may be a point.
[[nodiscard]] bool outsideSolids(const GridShape& shape, std::span<const std::uint8_t> blocked,
                                 const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept;

/// Throws InputError if the map is longer than kSightFarthest along an axis: lines between its
/// cells would be outside the domain of the two above.
void needSightSize(const VoxelMap& map);

}  // namespace tautline::planning
