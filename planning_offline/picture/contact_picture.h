#pragma once

/// @file
/// Pictures of the tether along a path. Not real-time safe: offline only.

#include <string>

#include <Eigen/Core>

#include "common/plot/figure.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/compare_contacts.h"
#include "planning_offline/tether/contact_plan.h"

namespace tautline::planning {

/// Path, reel, contacts, the tether wherever its contacts change and at the end, over the obstacles
/// that are in their way. All of M.
[[nodiscard]] plot::Figure contactFigure(const std::string& title, const VoxelMap& map,
                                         const Eigen::Vector3d& reel, const ContactPlan& plan);

/// Path, and both tethers at the last waypoint with the most contacts; the waypoints at which a
/// relaxation was refused.
[[nodiscard]] plot::Figure comparisonFigure(const std::string& title, const VoxelMap& map,
                                            const Eigen::Vector3d& reel,
                                            const ContactComparison& comparison);

}  // namespace tautline::planning
