#pragma once

/// @file
/// What all pictures of things over a map begin with. Not real-time safe: offline only.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/plot/figure.h"
#include "common/plot/views.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// The obstacles in the slab that the points (M [m]) need, two cells more on each side: the darker
/// the more of the slab they fill; unknown space is tinted.
[[nodiscard]] plot::Drawing mapDrawing(const std::string& title, const VoxelMap& map,
                                       const std::vector<Eigen::Vector3d>& points);

/// In the plane one view from above, in space three.
[[nodiscard]] plot::Figure mapFigure(const VoxelMap& map, const plot::Drawing& drawing);

}  // namespace tautline::planning
