#pragma once

/// @file
/// OctoMap files (Hornung et al., "OctoMap: an efficient probabilistic 3D mapping framework based
/// on octrees", Autonomous Robots 34, 2013). Their z is up; M has y up. Not real-time safe: offline
/// only.

#include <string>
#include <string_view>

#include <Eigen/Core>

#include "planning_offline/map/load_map.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

inline constexpr std::string_view kOctomapBinaryHeader = "# Octomap OcTree binary file";
inline constexpr std::string_view kOctomapFullHeader = "# Octomap OcTree file";

/// A point in a file with z up (x forward, y left) in M, and back: a cyclic change of axes, both
/// right-handed.
[[nodiscard]] inline Eigen::Vector3d fromZUp(const Eigen::Vector3d& p) {
  return {p.y(), p.z(), p.x()};
}
[[nodiscard]] inline Eigen::Vector3d toZUp(const Eigen::Vector3d& p) {
  return {p.z(), p.x(), p.y()};
}

/// `.bt` or `.ot`, by the first line. Grid over all that the tree knows, from its lower corner, at
/// its leaves' size unless `options.resolution` says otherwise. A cell is occupied if it meets any
/// occupied leaf (log-odds >= 0 in `.ot`), else unknown if it meets anything the tree does not
/// know. Trees: OcTree, ColorOcTree, OcTreeStamped. Throws InputError.
[[nodiscard]] VoxelMap octomapMap(std::string_view bytes, const std::string& file,
                                  const LoadOptions& options);

}  // namespace tautline::planning
