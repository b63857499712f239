#include "planning_offline/tether/test/prism.h"

#include <cmath>

#include "planning_offline/tether/convex_edges.h"
#include "planning_offline/tether/test/rubber_band.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

constexpr double kFine = 1024.0;

int below(int n, walks::Random& random) {
  return static_cast<int>(random() % static_cast<std::uint64_t>(n));
}

/// Occupies x0 <= x < x1, z0 <= z < z1 as far as it is in the map.
void fill(VoxelMap& plan, int x0, int x1, int z0, int z1) {
  for (int z = z0; z < z1; ++z) {
    for (int x = x0; x < x1; ++x) {
      if (plan.shape.contains({x, 0, z})) walks::occupy(plan, {x, 0, z});
    }
  }
}

/// Walls of one cell with a gap each, across the map by turns.
VoxelMap thinWalls(const GridShape& shape, walks::Random& random) {
  VoxelMap plan = walks::emptyMap(shape);
  for (int wall = 0; wall < 3; ++wall) {
    const int z = 2 + 3 * wall;
    const int gap = below(shape.nx, random);
    fill(plan, 0, gap, z, z + 1);
    fill(plan, gap + 1 + below(2, random), shape.nx, z, z + 1);
  }
  return plan;
}

/// Walls that bend, and ledges on them: boxes that share a face with another one.
VoxelMap corners(const GridShape& shape, walks::Random& random) {
  VoxelMap plan = walks::emptyMap(shape);
  for (int i = 0; i < 3; ++i) {
    const int x = 1 + below(shape.nx - 3, random);
    const int z = 1 + below(shape.nz - 3, random);
    const int arm = 2 + below(3, random);
    fill(plan, x, x + arm, z, z + 1);
    fill(plan, x, x + 1, z, z + arm);
    const int ledge = 1 + below(arm, random);
    fill(plan, x - 1, x, z + ledge, z + ledge + 1);
  }
  return plan;
}

/// Pairs of boxes that touch at an edge or along part of a face.
VoxelMap touchingBoxes(const GridShape& shape, walks::Random& random) {
  VoxelMap plan = walks::emptyMap(shape);
  for (int i = 0; i < 3; ++i) {
    const int x = 1 + below(shape.nx - 4, random);
    const int z = 1 + below(shape.nz - 4, random);
    const int side = 1 + below(2, random);
    const int shift = below(side + 1, random);
    fill(plan, x, x + side, z, z + side);
    fill(plan, x + side, x + 2 * side, z + shift, z + shift + side);
  }
  return plan;
}

VoxelMap randomPlan(std::uint64_t seed, walks::Random& random) {
  const GridShape shape{9 + below(4, random), 1, 10 + below(4, random)};
  switch (seed % 5) {
    case 0:
      return walks::clutteredMap(shape, 4 + below(7, random), random);
    case 1:
      return walks::boxesMap(shape, 7, 3, random);
    case 2:
      return thinWalls(shape, random);
    case 3:
      return corners(shape, random);
    default:
      return touchingBoxes(shape, random);
  }
}

VoxelMap extruded(const VoxelMap& plan, int axis, int length) {
  Eigen::Vector3i size;
  size[axisU(axis)] = plan.shape.nz;
  size[axisV(axis)] = plan.shape.nx;
  size[axis] = length;
  VoxelMap map = walks::emptyMap({size.x(), size.y(), size.z()});
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    if (plan.cells[i] != CellState::kOccupied) continue;
    const Eigen::Vector3i at = plan.shape.cell(static_cast<CellIndex>(i));
    Eigen::Vector3i cell;
    cell[axisU(axis)] = at.z();
    cell[axisV(axis)] = at.x();
    for (cell[axis] = 0; cell[axis] < length; ++cell[axis]) walks::occupy(map, cell);
  }
  return map;
}

}  // namespace

PrismWalk prismWalk(std::uint64_t seed, int steps) {
  walks::Random random(seed);
  PrismWalk walk;
  walk.axis = static_cast<int>(seed / 5 % 3);
  walk.plan = randomPlan(seed, random);
  walk.map = extruded(walk.plan, walk.axis, 6);
  walk.points = walks::centres(
      walk.map,
      walks::randomWalk(walks::freeLattice(walk.map, Connectivity::kVertices), steps, random));
  return walk;
}

PrismString shortestAmongPrisms(const PrismWalk& walk, std::size_t last) {
  const int axis = walk.axis;
  const double unit = walk.map.resolution / kFine;
  std::vector<BandPoint> path;
  for (std::size_t i = 0; i <= last; ++i) {
    const Eigen::Vector3d fine = (walk.points[i] - walk.map.origin) / unit;
    path.push_back({std::llround(fine[axisU(axis)]), std::llround(fine[axisV(axis)])});
  }
  const std::vector<BandPoint> band = tightened(walk.plan, path);
  std::vector<double> way{0.0};
  for (std::size_t i = 1; i < band.size(); ++i) {
    way.push_back(way.back() + unit * std::hypot(static_cast<double>(band[i].u - band[i - 1].u),
                                                 static_cast<double>(band[i].v - band[i - 1].v)));
  }
  const double from = walk.points.front()[axis];
  const double climb = walk.points[last][axis] - from;
  PrismString out;
  out.length = std::hypot(way.back(), climb);
  for (std::size_t i = 1; i + 1 < band.size(); ++i) {
    Eigen::Vector3d contact = walk.map.origin;
    contact[axisU(axis)] += unit * static_cast<double>(band[i].u);
    contact[axisV(axis)] += unit * static_cast<double>(band[i].v);
    contact[axis] = from + climb * way[i] / way.back();
    out.contacts.push_back(contact);
  }
  return out;
}

}  // namespace tautline::planning
