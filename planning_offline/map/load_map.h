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
  std::optional<double> resolution;  ///< Edge of a cell [m]; absent: the file's own (MovingAI: 1
                                     ///< m). A cell that touches the interior of anything occupied
                                     ///< is occupied; of the rest, unknown if it touches unknown.
  std::optional<Bounds> crop;  ///< Keep the cells that meet this box.
  std::optional<double>
      slice;  ///< Keep only the layer of cells at this height y [m]: a planar map.
  std::int64_t memory_limit{std::int64_t{4} << 30};  ///< Refuse maps that would need more [bytes].
};

/// The kind is told by the content where it can be, not by the name alone. Throws InputError: no
/// file, wrong kind, truncated, empty map, too much memory (with the number and what would fit),
/// crop or slice outside.
[[nodiscard]] VoxelMap loadMap(const std::filesystem::path& path, const LoadOptions& options);

}  // namespace tautline::planning
