#include "control/route.h"

#include <algorithm>

namespace tautline {

Route Route::along(const MissionPlan& plan) noexcept {
  Route out;
  out.plan_ = &plan;
  out.count_ = std::clamp(plan.waypoint_count, 0, kMaxWaypoints);
  return out;
}

Route Route::back(const MissionPlan& plan, int from, const Eigen::Vector3d& p_WStart) noexcept {
  Route out;
  out.plan_ = &plan;
  out.backwards_ = true;
  out.point_.p_WD = p_WStart;
  // From the leg towards `from`: the waypoints from - 1 … 0, then the start.
  out.count_ = std::clamp(from, 0, std::max(0, plan.waypoint_count - 1)) + 1;
  return out;
}

Route Route::to(const PointTarget& target) noexcept {
  Route out;
  out.point_ = target;
  out.count_ = 1;
  return out;
}

Leg Route::leg(int i) const noexcept {
  if (plan_ == nullptr) {
    return {.p_WD = point_.p_WD, .p_WL = point_.p_WL, .speed = point_.speed};
  }
  if (!backwards_) {
    const Waypoint& w = plan_->waypoints[static_cast<std::size_t>(i)];
    return {.p_WD = w.p_WD,
            .contact = w.contact,
            .p_WL = w.p_WL,
            .speed = w.speed,
            .hold = w.hold,
            .waypoint = i};
  }
  const int flown = outwardLeg(i);
  const Waypoint& w = plan_->waypoints[static_cast<std::size_t>(flown)];
  Leg out{.contact = w.contact, .speed = w.speed, .waypoint = std::max(0, flown - 1)};
  out.p_WD = flown > 0 ? plan_->waypoints[static_cast<std::size_t>(flown - 1)].p_WD : point_.p_WD;
  return out;
}

}  // namespace tautline
