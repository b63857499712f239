#pragma once

/// @file
/// A hand-written scene (common/mission/scene.h) as a voxel map. Not real-time safe: offline only.

#include <string>
#include <string_view>

#include "planning_offline/map/load_map.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Grid over the room from its lower corner. A cell is occupied if its interior meets the interior
/// of a box or prism, or reaches out of the room. A room as high as a cell gives a planar map.
/// Cells of a sharp obstacle are marked in VoxelMap::no_contact, also where others overlap it.
/// Layers are put on by cell centre, later rows over earlier ones. Rewards outside crop and slice
/// are left out. Throws InputError with file and row: what parseScene() refuses, an element that
/// reads no layer, a reward in no cell, what makeMap() refuses.
[[nodiscard]] VoxelMap sceneMap(std::string_view text, const std::string& file,
                                const LoadOptions& options);

}  // namespace tautline::planning
