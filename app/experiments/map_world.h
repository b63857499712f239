#pragma once

/// @file
/// The world that the plant flies a mission in, made of the map that it was planned in: occupied
/// voxels become boxes, and the drone is parked where the mission begins. Not real-time safe.

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "common/mission/scene.h"
#include "common/mission_plan.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::experiments {

/// Solid cells between planes that need not be equally far apart; x fastest, then y, then z.
struct SolidGrid {
  std::array<std::vector<double>, 3> planes;  ///< Of x, y, z: one more than there are cells [m].
  std::vector<std::uint8_t> solid;            ///< One a cell.

  [[nodiscard]] int cells(std::size_t axis) const noexcept {
    return static_cast<int>(planes[axis].size()) - 1;
  }
};

/// Occupied cells of the map. Planners think of the vehicle as a point, so the obstacles of their
/// maps are grown by the vehicle's radius; with `inflation` [m], below half a cell, the things
/// inside are found again: the occupied cells (and what is outside the map) less all that is
/// nearer than that to a cell which is not, in the sense of the largest coordinate.
[[nodiscard]] SolidGrid solidGrid(const planning::VoxelMap& map, double inflation);

/// Boxes that fill the solid cells exactly and do not overlap: from each cell that is not filled
/// yet as far as it goes along x, then y, then z.
[[nodiscard]] std::vector<Box> mergedBoxes(const SolidGrid& grid);

/// Of the tether's attachment over what the parked drone stands on [m].
inline constexpr double kFoot = 0.1;

/// The plant's world in W. Its room is the map's extent, widened by the inflation on all sides
/// (walls, ceiling and floor are occupied like the obstacles), if the map is walled (solid_border).
/// Otherwise only the floor is there, and 100 m of air round the map. The drone is parked on what
/// is below the mission's first waypoint. `reel` is the outlet in M; `inflation` as of solidGrid().
/// Throws InputError if there are more boxes than the plant takes, or the inflation is half a cell
/// or more.
[[nodiscard]] Scene worldOf(const planning::VoxelMap& map, const Eigen::Vector3d& reel,
                            const MissionPlan& mission, double inflation);

/// The same scene with its reel at `reel`: back from W to M.
[[nodiscard]] Scene sceneFromWorld(const Scene& world, const Eigen::Vector3d& reel);

}  // namespace tautline::experiments
