#include "planning_offline/tether/test/walks.h"

#include <algorithm>
#include <utility>

namespace tautline::planning::walks {
namespace {

int below(int n, Random& random) {  // not std::uniform_int_distribution: the same everywhere
  return static_cast<int>(random() % static_cast<std::uint64_t>(n));
}

}  // namespace

VoxelMap emptyMap(const GridShape& shape) {
  VoxelMap map;
  map.shape = shape;
  map.resolution = 0.5;
  map.origin = {-3.0, 0.25, 1.7};
  map.cells.assign(shape.size(), CellState::kFree);
  return map;
}

void occupy(VoxelMap& map, const Eigen::Vector3i& cell) {
  map.cells.at(static_cast<std::size_t>(map.shape.index(cell))) = CellState::kOccupied;
}

VoxelMap clutteredMap(const GridShape& shape, int one_in, Random& random) {
  VoxelMap map = emptyMap(shape);
  for (CellState& cell : map.cells) {
    if (below(one_in, random) == 0) cell = CellState::kOccupied;
  }
  return map;
}

VoxelMap boxesMap(const GridShape& shape, int count, int side, Random& random) {
  VoxelMap map = emptyMap(shape);
  const Eigen::Vector3i size(shape.nx, shape.ny, shape.nz);
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3i low;
    Eigen::Vector3i high;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = below(size[axis], random);
      high[axis] = std::min(size[axis], low[axis] + 1 + below(side, random));
    }
    for (int z = low.z(); z < high.z(); ++z) {
      for (int y = low.y(); y < high.y(); ++y) {
        for (int x = low.x(); x < high.x(); ++x) occupy(map, {x, y, z});
      }
    }
  }
  return map;
}

Lattice freeLattice(const VoxelMap& map, Connectivity connectivity) {
  std::vector<std::uint8_t> free;
  for (const CellState cell : map.cells) free.push_back(cell == CellState::kFree ? 1 : 0);
  return {map.shape, connectivity, std::move(free)};
}

std::vector<CellIndex> randomWalk(const Lattice& lattice, int steps, Random& random) {
  if (lattice.freeCount() == 0) return {};
  CellIndex cell = 0;
  do {
    cell = below(static_cast<int>(lattice.shape().size()), random);
  } while (!lattice.free(cell));
  std::vector<CellIndex> walk{cell};
  Direction last = kNoDirection;
  for (int step = 0; step < steps; ++step) {
    std::vector<Direction> open;
    for (const Direction d : lattice.directions()) {
      if ((lattice.moves(cell) >> d & 1U) != 0) open.push_back(d);
    }
    if (open.empty()) break;
    const bool ahead = last != kNoDirection && (lattice.moves(cell) >> last & 1U) != 0;
    Direction d = open[static_cast<std::size_t>(below(static_cast<int>(open.size()), random))];
    if (ahead && (below(2, random) == 0 || d == opposite(last))) d = last;
    cell = lattice.neighbour(cell, d);
    walk.push_back(cell);
    last = d;
  }
  return walk;
}

std::vector<Eigen::Vector3d> centres(const VoxelMap& map, const std::vector<CellIndex>& cells) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(cells.size());
  for (const CellIndex cell : cells) points.push_back(map.centre(cell));
  return points;
}

VoxelMap spaceMap(std::uint64_t seed, Random& random) {
  const GridShape shape{8, 8, 8};
  return seed % 2 == 0 ? clutteredMap(shape, 4 + static_cast<int>(seed % 9), random)
                       : boxesMap(shape, 14, 4, random);
}

std::vector<Eigen::Vector3d> spaceWalk(const VoxelMap& map, int steps, Random& random) {
  return centres(map, randomWalk(freeLattice(map, Connectivity::kVertices), steps, random));
}

}  // namespace tautline::planning::walks
