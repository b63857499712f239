#include "planning_offline/field/obstacles.h"

#include <algorithm>

#include "common/error.h"

namespace tautline::planning {

std::vector<std::uint8_t> obstacleCells(const VoxelMap& map, bool unknown_is_obstacle) {
  TAUTLINE_CHECK(map.cells.size() == map.shape.size());
  std::vector<std::uint8_t> obstacles(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), obstacles.begin(), [&](CellState state) {
    const bool obstacle =
        state == CellState::kOccupied || (state == CellState::kUnknown && unknown_is_obstacle);
    return static_cast<std::uint8_t>(obstacle);
  });
  return obstacles;
}

}  // namespace tautline::planning
