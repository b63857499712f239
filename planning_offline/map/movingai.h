#pragma once

/// @file
/// Map files of the MovingAI pathfinding benchmarks (N. Sturtevant, "Benchmarks for grid-based
/// pathfinding", IEEE TCIAIG 4(2), 2012, and movingai.com/benchmarks/formats.html). Cells are cubes
/// with an edge of `options.resolution`, 1 m if absent, from the origin of M. Not real-time safe:
/// offline only.

#include <string>
#include <string_view>

#include "planning_offline/map/load_map.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// `.map`: `type octile`, `height`, `width`, `map`, then one character a cell. Planar; x = column,
/// z = row. Passable: `.` and `G`; blocked: `@OTSW`. Throws InputError with file and line.
[[nodiscard]] VoxelMap movingAiPlane(std::string_view text, const std::string& file,
                                     const LoadOptions& options);

/// `.3dmap`: `voxel W H D`, then `x y z` of one occupied cell a line; x, y, z as in M. Throws
/// InputError with file and line.
[[nodiscard]] VoxelMap movingAiSpace(std::string_view text, const std::string& file,
                                     const LoadOptions& options);

}  // namespace tautline::planning
