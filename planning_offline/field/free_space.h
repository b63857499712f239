#pragma once

/// @file
/// Where the vehicle may be: free cells with enough clearance. Not real-time safe: offline only.

#include <cstdint>
#include <vector>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/progress.h"

namespace tautline::planning {

struct FreeSpaceOptions {
  double clearance{0.0};  ///< Vehicle radius + tolerance [m]: cells whose centre is nearer to an
                          ///< obstacle are not free.
  bool unknown_is_free{false};
  int threads{0};  ///< 0 = all cores.
};

/// One byte a cell, 1 = free. Obstacles are occupied cells, unknown cells (unless they are free),
/// and the outside of a map with a solid border. All 0 if cancelled.
[[nodiscard]] std::vector<std::uint8_t> freeSpace(const VoxelMap& map,
                                                  const FreeSpaceOptions& options,
                                                  const Progress& progress);

}  // namespace tautline::planning
