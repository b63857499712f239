#pragma once

/// @file
/// Cells that the tether must not touch: sharp edges (VoxelMap::no_contact). Not real-time safe:
/// offline only.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

class NoContactCells {
 public:
  /// None.
  NoContactCells() = default;

  /// Keeps a copy of what it needs of the map.
  explicit NoContactCells(const VoxelMap& map);

  [[nodiscard]] bool empty() const noexcept { return marked_.empty(); }

  /// True if the closed cube of a marked cell holds the contact, in M [m]. What is not farther from
  /// it along any axis than `standoff` [cells, 0 to 0.5] and 1e-5 of a cell counts as touching:
  /// contacts stop that near to the end of an edge.
  [[nodiscard]] bool touchedAt(const Eigen::Vector3d& contact,
                               double standoff = 0.0) const noexcept;

 private:
  GridShape shape_;
  double resolution_{1.0};
  Eigen::Vector3d origin_{Eigen::Vector3d::Zero()};
  std::vector<std::uint8_t> marked_;  ///< One a cell, or none.
};

}  // namespace tautline::planning
