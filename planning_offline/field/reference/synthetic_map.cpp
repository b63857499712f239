#include "planning_offline/field/reference/synthetic_map.h"

#include <algorithm>
#include <random>

namespace tautline::planning {
namespace {

void fillBox(VoxelMap& map, const Eigen::Vector3i& low, const Eigen::Vector3i& size,
             CellState state) {
  const Eigen::Vector3i end =
      (low + size).cwiseMin(Eigen::Vector3i(map.shape.nx, map.shape.ny, map.shape.nz));
  for (int z = std::max(0, low.z()); z < end.z(); ++z) {
    for (int y = std::max(0, low.y()); y < end.y(); ++y) {
      for (int x = std::max(0, low.x()); x < end.x(); ++x) {
        map.cells[static_cast<std::size_t>(map.shape.index({x, y, z}))] = state;
      }
    }
  }
}

}  // namespace

VoxelMap randomMap(const GridShape& shape, double occupied, double unknown, std::uint32_t seed) {
  VoxelMap map;
  map.name = "random";
  map.shape = shape;
  map.cells.resize(shape.size());
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  for (CellState& state : map.cells) {
    const double u = uniform(random);
    state = u < occupied             ? CellState::kOccupied
            : u < occupied + unknown ? CellState::kUnknown
                                     : CellState::kFree;
  }
  return map;
}

VoxelMap roomsMap(const GridShape& shape, std::uint32_t seed) {
  constexpr int kRoom = 25;
  VoxelMap map = randomMap(shape, 0.0, 0.0, seed);
  map.name = "rooms";
  map.resolution = 0.1;
  std::mt19937 random(seed);
  const auto below = [&random](int n) {
    return static_cast<int>(random() % static_cast<unsigned>(std::max(1, n)));
  };
  for (int x = 0; x < shape.nx; x += kRoom) {
    fillBox(map, {x, 0, 0}, {1, shape.ny, shape.nz}, CellState::kOccupied);
  }
  for (int z = 0; z < shape.nz; z += kRoom) {
    fillBox(map, {0, 0, z}, {shape.nx, shape.ny, 1}, CellState::kOccupied);
  }
  for (int x = 0; x < shape.nx; x += kRoom) {
    for (int z = 0; z < shape.nz; z += kRoom) {
      const int door = 2 + below(kRoom - 12);
      fillBox(map, {x, 0, z + door}, {1, shape.ny * 3 / 4, 9}, CellState::kFree);
      fillBox(map, {x + door, 0, z}, {9, shape.ny * 3 / 4, 1}, CellState::kFree);
      for (int box = 0; box < 4; ++box) {
        fillBox(map, {x + 2 + below(kRoom - 6), below(shape.ny), z + 2 + below(kRoom - 6)},
                {2 + below(6), 2 + below(12), 2 + below(6)}, CellState::kOccupied);
      }
    }
  }
  fillBox(map, {0, 0, 0}, {shape.nx, 1, shape.nz}, CellState::kOccupied);
  fillBox(map, {0, shape.ny - 1, 0}, {shape.nx, 1, shape.nz}, CellState::kOccupied);
  return map;
}

}  // namespace tautline::planning
