#pragma once

/// @file
/// Flights among prisms: obstacles that run through the whole map along one axis. There the
/// shortest string of a homotopy class is known: seen along the prisms it is the tight band of the
/// flight seen so (rubber_band.h), and it climbs evenly with its way. Shares nothing with the code
/// under test. Deterministic for a seed.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

struct PrismWalk {
  VoxelMap plan;  ///< Planar: its z and x are u and v of the prisms' axis.
  VoxelMap map;
  int axis{1};                          ///< Along the prisms.
  std::vector<Eigen::Vector3d> points;  ///< Flown in straight lines, M [m].
};

/// Random clutter, boxes that touch, thin walls, corners and ledges by turns, along each axis by
/// turns; `steps` moves between neighbouring free cells.
[[nodiscard]] PrismWalk prismWalk(std::uint64_t seed, int steps);

struct PrismString {
  double length{0.0};                     ///< [m]
  std::vector<Eigen::Vector3d> contacts;  ///< M [m], from the reel to the vehicle.
};

/// The shortest string after the walk came to points[last].
[[nodiscard]] PrismString shortestAmongPrisms(const PrismWalk& walk, std::size_t last);

}  // namespace tautline::planning
