#pragma once

/// @file
/// Maps that fields are timed on, as a grid and as an octree.

#include <octomap/octomap.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

struct BenchmarkScene {
  VoxelMap map;  ///< Axes as in the octree.
  std::unique_ptr<octomap::OcTree> tree;
};

/// The rooms of synthetic_map.h, 100 × 100 × 100 cells.
[[nodiscard]] const BenchmarkScene& roomsScene();

/// geb079.bt from TAUTLINE_DATA (default: shared/data beside the sources); null if it is not there.
[[nodiscard]] const BenchmarkScene* buildingScene();

/// Free cells to look from and to, by seed.
[[nodiscard]] std::vector<std::pair<CellIndex, CellIndex>> randomPairs(const VoxelMap& map,
                                                                       int count,
                                                                       std::uint32_t seed);

}  // namespace tautline::planning
