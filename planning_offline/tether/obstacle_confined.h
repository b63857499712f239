#pragma once

/// @file
/// ObstacleConfined() of the dissertation (chapter 5): whether an obstacle is confined in the
/// triangle of two contacts and a waypoint, judged by the projections onto the planes of the axes.
///
/// For one cell the three projections together are the separating-axis test of triangle and box
/// without one axis, the triangle's normal: necessary, but not sufficient, for the triangle to meet
/// the cell. A contact may be kept too long, never relaxed too early. Not real-time safe: offline
/// only.

#include <cstdint>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// When an obstacle's cell is confined in the projection of a triangle. The text does not say.
enum class Confinement : std::uint8_t {
  kTouching,      ///< Its square overlaps the triangle; a degenerate triangle is a segment.
  kCentreInside,  ///< Its centre is inside; a degenerate triangle confines nothing.
};

/// True if some occupied cell is confined in all three projections. Finite corners, in any order,
/// in cells: (p_M − origin) / resolution.
[[nodiscard]] bool obstacleConfined(const VoxelMap& map, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                                    Confinement reading = Confinement::kTouching);

}  // namespace tautline::planning
