#pragma once

/// @file
/// Pictures of plans and fields over a map: in the plane one view, in space three projections. Not
/// real-time safe: offline only.

#include <string>
#include <vector>

#include "common/plot/figure.h"
#include "common/plot/views.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/risk/risk_report.h"

namespace tautline::planning {

/// A path to draw: coloured by state risk if it is the only one, else in a colour of its own.
struct DrawnPath {
  std::string name;
  const RiskReport* report{nullptr};
};

/// Obstacles are those in the slab that the paths need (two cells more on each side), the darker
/// the more of the slab they fill; unknown space is tinted. Reel, rewards, contacts, start and end
/// are marked; the tether is drawn for the last state.
[[nodiscard]] plot::Figure planFigure(const std::string& title, const VoxelMap& map,
                                      const std::vector<DrawnPath>& paths,
                                      const std::vector<Reward>& rewards);

/// One layer of cells of a field at height index `y`, seen from above; obstacles grey, unknown
/// space white.
[[nodiscard]] plot::Figure fieldFigure(const std::string& title, const std::string& label,
                                       const VoxelMap& map, const std::vector<double>& field,
                                       int y);

}  // namespace tautline::planning
