#pragma once

/// @file
/// What a tether reaches from its reel. Not real-time safe: offline only.

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/progress.h"

namespace tautline::planning {

struct ReachOptions {
  double length_max{0.0};       ///< [m]; 0 = no limit.
  double elevation_min{-90.0};  ///< [deg] of a straight tether.
  int threads{0};
};

struct ReachMap {
  std::vector<std::uint8_t>
      straight;  ///< One a cell: free, and the straight tether from the reel to its centre meets
                 ///< no interior of an obstacle cell (touching faces is allowed).
  std::vector<std::uint8_t> with_contacts;  ///< Free and connected to the reel over faces.
  std::size_t free{0};
  std::size_t straight_count{0};
  std::size_t with_contacts_count{0};
};

/// `free` as freeSpace() gives it; obstacles for the tether are the map's occupied cells.
/// Throws InputError if the reel is inside an obstacle.
[[nodiscard]] ReachMap computeReach(const VoxelMap& map, const std::vector<std::uint8_t>& free,
                                    const Eigen::Vector3d& reel, const ReachOptions& options,
                                    const Progress& progress);

}  // namespace tautline::planning
