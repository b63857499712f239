#include "planning_offline/tether/reel_place.h"

#include <sstream>

#include "common/error.h"

namespace tautline::planning {
namespace {

/// `cell` may be outside the map.
bool occupied(const VoxelMap& map, const Eigen::Vector3i& cell) {
  return map.shape.contains(cell) &&
         map.cells[static_cast<std::size_t>(map.shape.index(cell))] == CellState::kOccupied;
}

}  // namespace

bool insideObstacle(const VoxelMap& map, const Eigen::Vector3d& p_cells) {
  constexpr double kTouching = 1e-9;  // [cells]: surfaces are met up to rounding
  const Eigen::Vector3i low = (p_cells.array() - kTouching).floor().cast<int>();
  const Eigen::Vector3i high = (p_cells.array() + kTouching).floor().cast<int>();
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        if (!occupied(map, {x, y, z})) return false;
      }
    }
  }
  return true;
}

const Eigen::Vector3d& checkedReel(const VoxelMap& map, const Eigen::Vector3d& reel) {
  const Eigen::Vector3d cells = (reel - map.origin) / map.resolution;
  // Written so that NaN fails.
  const bool near = (cells.array().abs() <= kFarthest).all();
  if (near && !insideObstacle(map, cells)) return reel;
  std::ostringstream where;
  where << '[' << reel.x() << ", " << reel.y() << ", " << reel.z() << "] m is "
        << (near ? "inside an obstacle" : "too far from the map");
  throw InputError({.file = map.file,
                    .key = "reel",
                    .problem = where.str(),
                    .allowed = "a free place on or near the map, or the surface of an obstacle"});
}

}  // namespace tautline::planning
