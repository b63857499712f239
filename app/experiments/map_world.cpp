#include "app/experiments/map_world.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/error.h"
#include "sim_hil/obstacles.h"

namespace tautline::experiments {
namespace {

using planning::CellState;
using planning::VoxelMap;

constexpr double kOpenAir = 100.0;  // round a map without walls [m]
constexpr int kParts = 3;           // of a cell along an axis: its two rims and its core

bool occupied(const VoxelMap& map, const Eigen::Vector3i& c) {
  return !map.shape.contains(c) ||
         map.cells[static_cast<std::size_t>(map.shape.index(c))] == CellState::kOccupied;
}

/// The neighbour that a part of a cell is near to: -1, 0 or 1 along an axis.
int side(int part) { return part % kParts - 1; }

/// Is every cell occupied that is near the part of a cell?
bool deepInside(const VoxelMap& map, const Eigen::Vector3i& part) {
  const Eigen::Vector3i cell = part / kParts;
  const Eigen::Vector3i s(side(part.x()), side(part.y()), side(part.z()));
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i near(corner & 1 ? s.x() : 0, corner & 2 ? s.y() : 0,
                               corner & 4 ? s.z() : 0);
    if (!occupied(map, cell + near)) return false;
  }
  return true;
}

std::vector<double> planesOf(double origin, int cells, double size, double inflation) {
  std::vector<double> planes;
  for (int i = 0; i < cells; ++i) {
    planes.push_back(origin + size * i);
    if (inflation > 0.0) {
      planes.push_back(origin + size * i + inflation);
      planes.push_back(origin + size * (i + 1) - inflation);
    }
  }
  planes.push_back(origin + size * cells);
  return planes;
}

/// The box from cell `from` on that is as long as it can be along x, then y, then z; its cells are
/// taken out.
class BoxGrower {
 public:
  explicit BoxGrower(const SolidGrid& grid) : grid_(grid), left_(grid.solid) {}

  [[nodiscard]] bool solid(const Eigen::Vector3i& c) const { return left_[index(c)] != 0; }

  Box grow(const Eigen::Vector3i& from) {
    Eigen::Vector3i to = from + Eigen::Vector3i::Ones();
    for (int axis = 0; axis < 3; ++axis) {
      while (to[axis] < grid_.cells(static_cast<std::size_t>(axis)) && layerSolid(from, to, axis))
        ++to[axis];
    }
    forEach(from, to, [&](const Eigen::Vector3i& c) {
      left_[index(c)] = 0;
      return true;
    });
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
      const std::vector<double>& planes = grid_.planes[static_cast<std::size_t>(axis)];
      box.min[axis] = planes[static_cast<std::size_t>(from[axis])];
      box.max[axis] = planes[static_cast<std::size_t>(to[axis])];
    }
    return box;
  }

 private:
  [[nodiscard]] std::size_t index(const Eigen::Vector3i& c) const {
    return static_cast<std::size_t>((c.z() * grid_.cells(1) + c.y()) * grid_.cells(0) + c.x());
  }
  template <class Visit>
  bool forEach(const Eigen::Vector3i& from, const Eigen::Vector3i& to, Visit visit) const {
    for (int z = from.z(); z < to.z(); ++z)
      for (int y = from.y(); y < to.y(); ++y)
        for (int x = from.x(); x < to.x(); ++x)
          if (!visit(Eigen::Vector3i(x, y, z))) return false;
    return true;
  }
  [[nodiscard]] bool layerSolid(Eigen::Vector3i from, Eigen::Vector3i to, int axis) const {
    from[axis] = to[axis];
    ++to[axis];
    return forEach(from, to, [&](const Eigen::Vector3i& c) { return solid(c); });
  }

  const SolidGrid& grid_;
  std::vector<std::uint8_t> left_;
};

/// Height of what a vehicle at p stands on: the highest box below it, or the floor.
double groundBelow(const Eigen::Vector3d& p, const Scene& scene) {
  double ground = scene.floor;
  for (const Box& box : scene.boxes) {
    const bool under = box.min.x() <= p.x() && p.x() <= box.max.x() && box.min.z() <= p.z() &&
                       p.z() <= box.max.z() && box.max.y() <= p.y();
    if (under) ground = std::max(ground, box.max.y());
  }
  return ground;
}

/// A planner goes nowhere beyond the map's border, so what is there is occupied like the obstacles,
/// and the real walls, ceiling and floor stand behind it as things stand inside their voxels. What
/// stands against the border goes on up to them.
void moveBorderOut(Scene& scene, double inflation) {
  for (Box& box : scene.boxes) {
    for (int axis = 0; axis < 3; ++axis) {
      if (box.min[axis] <= scene.min[axis]) box.min[axis] -= inflation;
      if (box.max[axis] >= scene.max[axis]) box.max[axis] += inflation;
    }
  }
  scene.min.array() -= inflation;
  scene.max.array() += inflation;
}

}  // namespace

SolidGrid solidGrid(const VoxelMap& map, double inflation) {
  TAUTLINE_CHECK(inflation >= 0.0 && inflation < 0.5 * map.resolution);
  SolidGrid grid;
  const std::array<int, 3> cells{map.shape.nx, map.shape.ny, map.shape.nz};
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.planes[axis] = planesOf(map.origin[static_cast<Eigen::Index>(axis)], cells[axis],
                                 map.resolution, inflation);
  grid.solid.reserve(static_cast<std::size_t>(grid.cells(0)) *
                     static_cast<std::size_t>(grid.cells(1)) *
                     static_cast<std::size_t>(grid.cells(2)));
  for (int z = 0; z < grid.cells(2); ++z) {
    for (int y = 0; y < grid.cells(1); ++y) {
      for (int x = 0; x < grid.cells(0); ++x) {
        const Eigen::Vector3i c(x, y, z);
        grid.solid.push_back(inflation > 0.0 ? deepInside(map, c) : occupied(map, c));
      }
    }
  }
  return grid;
}

std::vector<Box> mergedBoxes(const SolidGrid& grid) {
  BoxGrower grower(grid);
  std::vector<Box> boxes;
  for (int z = 0; z < grid.cells(2); ++z) {
    for (int y = 0; y < grid.cells(1); ++y) {
      for (int x = 0; x < grid.cells(0); ++x) {
        if (!grower.solid({x, y, z})) continue;
        boxes.push_back(grower.grow({x, y, z}));
        boxes.back().name = fmt::format("solid_{}", boxes.size());
      }
    }
  }
  return boxes;
}

Scene worldOf(const VoxelMap& map, const Eigen::Vector3d& reel, const MissionPlan& mission,
              double inflation) {
  TAUTLINE_CHECK(mission.waypoint_count > 0);
  if (inflation < 0.0 || inflation >= 0.5 * map.resolution) {
    throw InputError({.key = "--inflation",
                      .problem = fmt::format("is {:g} m", inflation),
                      .allowed = fmt::format("0 to less than {:g} m, half a cell of the map {}",
                                             0.5 * map.resolution, map.name)},
                     ExitCode::kUsage);
  }
  Scene scene;
  scene.name = map.name;
  scene.resolution = map.resolution;
  scene.min = map.origin;
  scene.max =
      map.origin + map.resolution * Eigen::Vector3d(map.shape.nx, map.shape.ny, map.shape.nz);
  scene.boxes = mergedBoxes(solidGrid(map, inflation));
  moveBorderOut(scene, inflation);
  if (!map.solid_border) {
    scene.min -= Eigen::Vector3d(kOpenAir, 0.0, kOpenAir);
    scene.max += Eigen::Vector3d::Constant(kOpenAir);
  }
  scene.floor = scene.min.y();
  if (scene.boxes.size() > static_cast<std::size_t>(sim::kMaxSolids)) {
    throw InputError(
        {.file = map.file,
         .problem = fmt::format("its obstacles are {} boxes", scene.boxes.size()),
         .allowed = fmt::format("at most {} in the simulated machine's world", sim::kMaxSolids),
         .remedy = "a coarser map, or a smaller part of it: --resolution, --crop"});
  }
  scene.reel = reel;
  Eigen::Vector3d start = reel + mission.waypoints[0].p_WD;
  start.y() = groundBelow(start, scene) + kFoot;
  scene.start = start;
  return sceneInWorld(scene);
}

Scene sceneFromWorld(const Scene& world, const Eigen::Vector3d& reel) {
  Scene scene = world;
  scene.reel = -reel;  // of a scene whose reel is there, W's origin is the reel of the other
  scene = sceneInWorld(scene);
  scene.reel = reel;
  return scene;
}

}  // namespace tautline::experiments
