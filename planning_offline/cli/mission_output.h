#pragma once

/// @file
/// Paths with their tether as mission files. Not real-time safe: offline only.

#include <filesystem>
#include <string>
#include <vector>

#include "common/mission/mission_file.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/contact_plan.h"

namespace tautline::planning {

/// Throws InputError (usage) if the map has no reel: asked before anything is planned for a
/// mission.
void needReel(const VoxelMap& map);

/// The path as a mission (docs/mission_files.md), shifted to the reel of the map; its map is given
/// relative to the folder of `file`. A contact forms or comes off on arrival at a waypoint, so
/// where one does so within a leg a waypoint is put in, in line with the old and the new anchor;
/// where several do so at one place, as many waypoints are at that place. A contact at the place of
/// the anchor below it (1 mm) is left out. `orders`: one a state, of which speed, hold, look-at and
/// risk are taken; a waypoint that was put in has those of the state it leads to, but no hold.
/// Throws InputError: no reel, or more waypoints or contacts than a mission holds.
[[nodiscard]] Mission missionOf(const ContactPlan& plan, const std::vector<Waypoint>& orders,
                                const VoxelMap& map, const std::string& description,
                                const std::filesystem::path& file);

}  // namespace tautline::planning
