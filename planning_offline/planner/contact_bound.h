#pragma once

/// @file
/// How many contacts a taut string to a cell has at least, whatever path led there: its contacts
/// are convex corners of obstacles, and each of its segments is a free line. Not real-time safe:
/// offline only.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// For a map and a reel [m, M]; works out what it is asked for only, and on maps with very many
/// corners not all of that: the bound stays valid, and the same every time. In space it tells no
/// more than whether there is one: contacts there may lie anywhere on an edge.
class ContactBound {
 public:
  /// `map` must outlive it. Throws InputError for maps that are too long (needSightSize()).
  ContactBound(const VoxelMap& map, const Eigen::Vector3d& reel);

  [[nodiscard]] int at(CellIndex cell);

 private:
  using Points = std::vector<Eigen::Vector3d>;  // in cell units

  [[nodiscard]] bool sees(const Points& from, const Eigen::Vector3d& to);
  [[nodiscard]] Eigen::Vector3d inCells(const Eigen::Vector3d& point) const;
  [[nodiscard]] bool occupied(int x, int z) const;
  [[nodiscard]] Points convexCorners(double y) const;
  [[nodiscard]] bool haveLayer(std::size_t k);

  const VoxelMap* map_;
  std::vector<std::uint8_t> occupied_;  // one byte a cell
  std::vector<Points> layers_;          // where the k-th contact of a string with k can be; 0: reel
  Points rest_;                         // corners that are in no layer yet
  std::vector<std::int8_t> known_;      // one a cell; -1 = not asked yet
  std::size_t tests_left_;              // of lines
};

}  // namespace tautline::planning
