#include "planning_offline/tether/taut_string.h"

#include "planning_offline/tether/pinned_string.h"
#include "planning_offline/tether/planar_string.h"

namespace tautline::planning {

std::unique_ptr<TautString> makeTautString(const VoxelMap& map, const Eigen::Vector3d& reel) {
  std::unique_ptr<TreeString> string;
  if (map.shape.planar()) {
    string = std::make_unique<PlanarString>(map, reel);
  } else {
    string = std::make_unique<PinnedString>(map, reel);
  }
  string->forbid(NoContactCells(map));
  return string;
}

}  // namespace tautline::planning
