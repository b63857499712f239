#include "supervision/detect/contact_watch.h"

#include <algorithm>
#include <cmath>

namespace tautline {

/// The longest stretch of the straight line inside one obstacle [m].
double ContactWatch::throughObstacles(const Eigen::Vector3d& p_WA,
                                      const Eigen::Vector3d& p_WD) const noexcept {
  double longest = 0.0;
  for (const FenceObstacle& obstacle : obstacles_.all()) {
    if (const auto hit = intersect(p_WA, p_WD, obstacle.view()))
      longest = std::max(longest, (hit->t_out - hit->t_in) * (p_WD - p_WA).norm());
  }
  return longest;
}

void ContactWatch::update(Time now, const ContactWatchInput& in, Findings& out) noexcept {
  const double dt = last_ && now > *last_ ? toSeconds(now - *last_) : 0.0;
  last_ = now;
  if (!in.flying || !in.usable) {
    clear_of_map_ = innovations_small_ = now;
    height_residual_ = 0.0;
    return;
  }
  const double through = throughObstacles(in.p_WA, in.p_WD);
  if (through < config_.through_obstacle_m) clear_of_map_ = now;
  if (in.nis < config_.nis) innovations_small_ = now;
  if (in.height_residual) {
    height_residual_ +=
        (1.0 - std::exp(-dt / config_.height_time_s)) * (*in.height_residual - height_residual_);
  } else {
    height_residual_ = 0.0;
  }
  const auto lasts = [&](Time since, double seconds) { return toSeconds(now - since) > seconds; };
  const double height = std::abs(height_residual_) / config_.height_residual_m;
  const bool is = lasts(clear_of_map_, config_.through_time_s) ||
                  lasts(innovations_small_, config_.nis_time_s) || height > 1.0;
  out.report(Condition::kUnplannedContact, is,
             std::max({through / config_.through_obstacle_m, in.nis / config_.nis, height}), 1.0);
}

}  // namespace tautline
