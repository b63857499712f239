#pragma once

/// @file
/// What the tests of the dissertation's contact planner share.

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/published_contacts.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {

using Points = std::vector<Eigen::Vector3d>;

/// Contacts on the very corners, lines sampled finely: what is left of differences from the taut
/// string is the algorithm's own.
inline constexpr PublishedOptions kIdeal{
    .placement = ContactPlacement::kCorner, .sample_step = 0.01, .standoff = 0.0};

/// A planar map drawn in rows along z, '#' occupied, x to the right.
inline VoxelMap drawnMap(const std::vector<std::string>& rows) {
  VoxelMap map =
      walks::emptyMap({static_cast<int>(rows[0].size()), 1, static_cast<int>(rows.size())});
  for (int z = 0; z < map.shape.nz; ++z) {
    for (int x = 0; x < map.shape.nx; ++x) {
      if (rows[static_cast<std::size_t>(z)][static_cast<std::size_t>(x)] == '#')
        walks::occupy(map, {x, 0, z});
    }
  }
  return map;
}

/// A point in M in cells from the map's origin.
inline Eigen::Vector3d inCells(const VoxelMap& map, const Eigen::Vector3d& p_M) {
  return (p_M - map.origin) / map.resolution;
}

}  // namespace tautline::planning
