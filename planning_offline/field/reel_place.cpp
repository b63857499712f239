#include "planning_offline/field/reel_place.h"

#include <string>
#include <utility>

#include <fmt/core.h>

#include "common/error.h"

namespace tautline::planning {
namespace {

/// Whether `blocked` holds for the indices of all cells that a point touches; it does not for cells
/// off the map.
template <class Blocked>
bool allTouched(const GridShape& shape, const Eigen::Vector3d& p_cells, Blocked blocked) {
  constexpr double kTouching = 1e-9;  // [cells]: surfaces are met up to rounding
  const Eigen::Vector3i low = (p_cells.array() - kTouching).floor().cast<int>();
  const Eigen::Vector3i high = (p_cells.array() + kTouching).floor().cast<int>();
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        const Eigen::Vector3i cell(x, y, z);
        if (!shape.contains(cell) || !blocked(static_cast<std::size_t>(shape.index(cell))))
          return false;
      }
    }
  }
  return true;
}

}  // namespace

bool insideObstacle(const VoxelMap& map, const Eigen::Vector3d& p_cells) {
  return allTouched(map.shape, p_cells,
                    [&](std::size_t i) { return map.cells[i] == CellState::kOccupied; });
}

const Eigen::Vector3d& checkedReel(const VoxelMap& map, const Eigen::Vector3d& reel,
                                   const ReelRule& rule) {
  TAUTLINE_CHECK(rule.farthest <= kFarthest);
  TAUTLINE_CHECK(rule.blocked.empty() || rule.blocked.size() == map.shape.size());
  const Eigen::Vector3d cells = (reel - map.origin) / map.resolution;
  const auto refuse = [&](const char* problem, std::string allowed) {
    return InputError({.file = map.file,
                       .key = "reel",
                       .problem = fmt::format("({:g}, {:g}, {:g}) m is {}", reel.x(), reel.y(),
                                              reel.z(), problem),
                       .allowed = std::move(allowed)});
  };
  // Written so that NaN fails.
  if (!(cells.array().abs() <= rule.farthest).all()) {
    throw refuse("too far from the map",
                 fmt::format("within {:g} m of its corner", rule.farthest * map.resolution));
  }
  const bool inside =
      rule.blocked.empty()
          ? insideObstacle(map, cells)
          : allTouched(map.shape, cells, [&](std::size_t i) { return rule.blocked[i] != 0; });
  if (!inside) return reel;
  throw refuse("inside an obstacle",
               rule.blocked.empty()
                   ? "a place outside all obstacles, or on a surface"
                   : "a place outside all obstacles and their tether clearance, or on a surface");
}

}  // namespace tautline::planning
