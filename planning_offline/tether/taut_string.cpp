#include "planning_offline/tether/taut_string.h"

#include "planning_offline/tether/pinned_string.h"
#include "planning_offline/tether/planar_string.h"

namespace tautline::planning {

std::unique_ptr<TautString> makeTautString(const VoxelMap& map, const Eigen::Vector3d& reel) {
  if (map.shape.planar()) return std::make_unique<PlanarString>(map, reel);
  return std::make_unique<PinnedString>(map, reel);
}

}  // namespace tautline::planning
