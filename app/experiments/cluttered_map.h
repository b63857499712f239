#pragma once

/// @file
/// Cluttered rooms made from a seed: columns, beams and blocks round a ground robot with reel and
/// drone, as on the dissertation's staircase. Not real-time safe.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/cli/workspace.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::experiments {

/// Room, voxels, reel and start are those of staircase.scene.toml; `things` obstacles on voxel
/// borders, none of them near reel, start and the way between. The same for the same arguments, on
/// every machine.
[[nodiscard]] planning::VoxelMap clutteredMap(int things, std::uint32_t seed);

/// The map with its moves (26 neighbours) and its risk.
[[nodiscard]] planning::RiskSpace riskSpaceOf(planning::VoxelMap map,
                                              const planning::RiskParams& params);

/// Up to `count` different free cells at least `far` metres from the start that moves lead to, by
/// chance; centres, M [m].
[[nodiscard]] std::vector<Eigen::Vector3d> goalsIn(const planning::RiskSpace& space,
                                                   std::size_t count, double far,
                                                   std::uint32_t seed);

}  // namespace tautline::experiments
