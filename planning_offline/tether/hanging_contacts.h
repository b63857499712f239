#pragma once

/// @file
/// Where contacts form if the tether is not straight: it hangs through, and so comes to an upright
/// edge below the straight line (docs/taut_string.md, "Sag"). Not real-time safe: offline only.

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

struct ContactPlan;

/// The tether as the vehicle holds it.
struct HangingTether {
  double weight{0.0};   ///< Per length [N/m], >= 0; 0 = straight.
  double tension{0.0};  ///< At the vehicle [N], > 0.
};

/// Height on the upright line through `contact` at which a tether from `anchor` to `vehicle` passes
/// it; contact.y() if it cannot hang so at this tension, or if `contact` is not between them.
[[nodiscard]] double heightPassed(const HangingTether& tether, const Eigen::Vector3d& anchor,
                                  const Eigen::Vector3d& contact, const Eigen::Vector3d& vehicle);

/// Moves each contact on an upright edge of the map to where the hanging tether meets that edge
/// when it forms there, not beyond the edge's ends, and all lengths with it. Other contacts stay:
/// on a level edge sag moves the time, not the place.
void hangContacts(const VoxelMap& map, const Eigen::Vector3d& reel, const HangingTether& tether,
                  ContactPlan& plan);

}  // namespace tautline::planning
