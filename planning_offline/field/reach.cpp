#include "planning_offline/field/reach.h"

#include <algorithm>
#include <limits>

#include "common/error.h"
#include "planning_offline/field/distance_field.h"
#include "planning_offline/field/free_space.h"
#include "planning_offline/field/line_of_sight.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/parallel.h"
#include "planning_offline/field/reel_place.h"

namespace tautline::planning {
namespace {

/// Cells that stop the tether.
std::vector<std::uint8_t> tetherObstacles(const VoxelMap& map, const ReachOptions& options,
                                          const Progress& progress) {
  if (options.tether_clearance <= 0.0) return obstacleCells(map, false);
  VoxelMap inside = map;
  inside.solid_border = false;  // a tether may lie along the walls of its room
  std::vector<std::uint8_t> cells =
      freeSpace(inside, {options.tether_clearance, true, options.threads}, progress);
  for (std::uint8_t& cell : cells) cell = cell == 0 ? 1 : 0;
  return cells;
}

/// Which of the cells that a straight tether reaches are within the limits.
void countWithinLimits(const VoxelMap& map, const Eigen::Vector3d& reel, const TetherLimits& limits,
                       ReachMap& reach) {
  for (std::size_t n = 0; n < reach.straight.size(); ++n) {
    if (reach.straight[n] == 0) continue;
    const Eigen::Vector3d vehicle = map.centre(static_cast<CellIndex>(n));
    const bool short_enough = limits.allowsLength((vehicle - reel).norm());
    const bool high_enough = limits.allowsElevation(reel, vehicle);
    reach.straight_within_length += short_enough ? 1U : 0U;
    reach.straight_within_elevation += high_enough ? 1U : 0U;
    reach.straight_within_limits += short_enough && high_enough ? 1U : 0U;
  }
}

/// All free cells connected over faces to a free one.
std::vector<std::uint8_t> connectedTo(const GridShape& shape, std::span<const std::uint8_t> free,
                                      CellIndex seed) {
  std::vector<std::uint8_t> connected(shape.size(), 0);
  std::vector<CellIndex> open{seed};
  connected[static_cast<std::size_t>(seed)] = 1;
  while (!open.empty()) {
    const Eigen::Vector3i cell = shape.cell(open.back());
    open.pop_back();
    for (int axis = 0; axis < 3; ++axis) {
      for (const int sign : {-1, 1}) {
        Eigen::Vector3i next = cell;
        next[axis] += sign;
        if (!shape.contains(next)) continue;
        const CellIndex i = shape.index(next);
        if (free[static_cast<std::size_t>(i)] == 0 || connected[static_cast<std::size_t>(i)] != 0) {
          continue;
        }
        connected[static_cast<std::size_t>(i)] = 1;
        open.push_back(i);
      }
    }
  }
  return connected;
}

/// The seen cell nearest to the reel, the lowest index of equals; kNoCell if none is seen.
CellIndex nearestSeen(const VoxelMap& map, const std::vector<std::uint8_t>& seen,
                      const Eigen::Vector3d& reel) {
  CellIndex nearest = kNoCell;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < seen.size(); ++n) {
    if (seen[n] == 0) continue;
    const auto i = static_cast<CellIndex>(n);
    const double distance = (map.centre(i) - reel).squaredNorm();
    if (distance >= smallest) continue;
    smallest = distance;
    nearest = i;
  }
  return nearest;
}

std::size_t countOf(std::span<const std::uint8_t> cells) {
  return static_cast<std::size_t>(std::count(cells.begin(), cells.end(), std::uint8_t{1}));
}

}  // namespace

ReachMap computeReach(const VoxelMap& map, std::span<const std::uint8_t> free,
                      const Eigen::Vector3d& reel, const ReachOptions& options,
                      const Progress& progress) {
  const GridShape& shape = map.shape;
  TAUTLINE_CHECK(free.size() == shape.size());
  needSightSize(map);
  const std::vector<std::uint8_t> obstacles = tetherObstacles(map, options, progress);
  // A cancelled inflation says nothing about the reel.
  const std::span<const std::uint8_t> kept_out =
      progress.cancelled() ? std::span<const std::uint8_t>{} : obstacles;
  const Eigen::Vector3d reel_cells =
      (checkedReel(map, reel, {.farthest = kSightFarthest, .blocked = kept_out}) - map.origin) /
      map.resolution;

  ReachMap reach;
  reach.straight.resize(shape.size(), 0);
  const bool complete =
      parallelFor(shape.nz, options.threads, progress, {"straight tether"}, [&](int z) {
        const CellIndex begin = shape.index({0, 0, z});
        for (CellIndex i = begin; i < begin + shape.nx * shape.ny; ++i) {
          const auto n = static_cast<std::size_t>(i);
          if (free[n] == 0) continue;
          const Eigen::Vector3d target = shape.cell(i).cast<double>().array() + 0.5;
          if (lineOfSight(shape, obstacles, reel_cells, target)) reach.straight[n] = 1;
        }
      });
  reach.take_off = complete ? nearestSeen(map, reach.straight, reel) : kNoCell;
  reach.with_contacts = reach.take_off == kNoCell ? std::vector<std::uint8_t>(shape.size(), 0)
                                                  : connectedTo(shape, free, reach.take_off);
  reach.free = countOf(free);
  reach.straight_count = countOf(reach.straight);
  countWithinLimits(map, reel, options.limits, reach);
  reach.with_contacts_count = countOf(reach.with_contacts);
  return reach;
}

}  // namespace tautline::planning
