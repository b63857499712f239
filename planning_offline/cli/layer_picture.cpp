#include "planning_offline/cli/layer_picture.h"

#include <cmath>

#include <fmt/core.h>

#include "common/error.h"

namespace tautline::planning {

void LayerPicture::addTo(CLI::App& verb) {
  verb.add_option("--svg", svg, "Draw one layer of cells")->type_name("FILE");
  verb.add_option("--height", height, "Height y of that layer [m]; default: the middle");
}

int LayerPicture::layerOf(const VoxelMap& map) const {
  if (!std::isfinite(height)) return map.shape.ny / 2;
  const int y = static_cast<int>(std::floor((height - map.origin.y()) / map.resolution));
  if (y >= 0 && y < map.shape.ny) return y;
  throw InputError({.key = "--height",
                    .problem = fmt::format("{:g} m is outside the map {}", height, map.name),
                    .allowed = fmt::format("{:g} to {:g}", map.origin.y(),
                                           map.origin.y() + map.resolution * map.shape.ny)},
                   ExitCode::kUsage);
}

std::string LayerPicture::titleOf(const std::string& what, const VoxelMap& map, int layer) {
  return fmt::format("{} at y = {:.2f} m", what, map.origin.y() + map.resolution * (layer + 0.5));
}

}  // namespace tautline::planning
