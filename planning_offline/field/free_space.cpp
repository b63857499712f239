#include "planning_offline/field/free_space.h"

#include <algorithm>

#include "planning_offline/field/distance_field.h"
#include "planning_offline/field/obstacles.h"

namespace tautline::planning {
namespace {

// Distances are floats: a passage that fits exactly must not be closed by their rounding.
constexpr double kFits = 1.0 - 1e-6;

}  // namespace

std::vector<std::uint8_t> freeSpace(const VoxelMap& map, const FreeSpaceOptions& options,
                                    const Progress& progress) {
  std::vector<std::uint8_t> free(map.shape.size(), 0);
  const DistanceOptions distance_options{.resolution = map.resolution,
                                         .cap = options.clearance + map.resolution,
                                         .solid_border = map.solid_border,
                                         .threads = options.threads};
  const std::vector<float> distance =
      distanceField(map.shape, obstacleCells(map, !options.unknown_is_free), distance_options,
                    progress, {"free space"});
  const auto needed = static_cast<float>(options.clearance * kFits);
  std::transform(distance.begin(), distance.end(), free.begin(),
                 [needed](float d) { return static_cast<std::uint8_t>(d > 0.0F && d >= needed); });
  return free;
}

}  // namespace tautline::planning
