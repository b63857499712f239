#pragma once

/// @file
/// The options of verbs that draw one layer of a map's cells. Not real-time safe: offline only.

#include <limits>
#include <string>

#include <CLI/App.hpp>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

struct LayerPicture {
  std::string svg;  ///< File; empty: no picture.
  double height{
      std::numeric_limits<double>::quiet_NaN()};  ///< y of the layer [m]; NaN: the middle.

  void addTo(CLI::App& verb);

  /// Height index of the layer. Throws InputError (usage) if the height is outside the map.
  [[nodiscard]] int layerOf(const VoxelMap& map) const;

  /// "what at y = 1.25 m".
  [[nodiscard]] static std::string titleOf(const std::string& what, const VoxelMap& map, int layer);
};

}  // namespace tautline::planning
