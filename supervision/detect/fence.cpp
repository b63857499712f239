#include "supervision/detect/fence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tautline {

double clearance(const Eigen::Vector3d& p_W, const FenceObstacles& obstacles) noexcept {
  double nearest = std::numeric_limits<double>::max();
  for (const FenceObstacle& obstacle : obstacles.all())
    nearest = std::min(nearest, signedDistance(p_W, obstacle.view()));
  return nearest;
}

void Fence::update(const FenceInput& in, Findings& out) const noexcept {
  const FenceConfig& c = config_;
  const Eigen::Vector3d& p = in.p_WD;
  out.reportAbove(Condition::kFenceLength, in.L_total, c.max_length_m);
  out.reportAbove(Condition::kFenceAltitude, p.y(), c.max_height_m);
  out.reportBelow(Condition::kFenceAltitude, p.y(), c.min_height_m);
  double depth = -std::numeric_limits<double>::max();  // of the deepest box
  for (const KeepOut& box : c.keep_out.all())
    depth = std::max(depth, (p - box.min_m).cwiseMin(box.max_m - p).minCoeff());
  if (!c.keep_out.all().empty()) out.reportAbove(Condition::kFenceKeepOut, depth, 0.0);
  if (!in.flying) return;
  const double elevation = std::atan2(p.y(), std::hypot(p.x(), p.z()));
  out.reportAbove(Condition::kFenceElevation, elevation, c.max_elevation_rad);
  out.reportBelow(Condition::kFenceElevation, elevation, c.min_elevation_rad);
  if (!c.obstacles.all().empty())
    out.reportBelow(Condition::kFenceClearance, clearance(p, c.obstacles), c.min_clearance_m);
}

}  // namespace tautline
