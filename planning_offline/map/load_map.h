#pragma once

/// @file
/// Map files (docs/maps.md): OctoMap `.bt`/`.ot`, MovingAI `.map` and `.3dmap`, hand-written
/// `.scene.toml`. Not real-time safe: offline only.

#include <cstdint>
#include <filesystem>
#include <optional>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Part of space, M [m], min < max.
struct Bounds {
  Eigen::Vector3d min{Eigen::Vector3d::Zero()};
  Eigen::Vector3d max{Eigen::Vector3d::Zero()};
};

struct LoadOptions {
  /// Edge of a cell [m], 0.001 to 1000; absent: the file's own (MovingAI: 1 m). A cell whose
  /// interior meets anything occupied is occupied; of the rest, unknown if it meets unknown. In
  /// MovingAI files it is the size of their cells.
  std::optional<double> resolution{};
  std::optional<Bounds> crop{};  ///< Keep the cells that meet the interior of this box.
  /// Keep only the layer of cells at this height y [m]: a planar map.
  std::optional<double> slice{};
  std::int64_t memory_limit{std::int64_t{4} << 30};  ///< Refuse maps that would need more [bytes].
};

/// The kind is told by the content; a name that says otherwise is an error. Throws InputError: no
/// file, wrong kind, truncated, empty map, too much memory (with the number and what would fit),
/// crop or slice outside. Prints nothing.
[[nodiscard]] VoxelMap loadMap(const std::filesystem::path& path, const LoadOptions& options);

}  // namespace tautline::planning
