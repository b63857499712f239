#include "control/route.h"

#include <algorithm>

namespace tautline {

Route Route::along(const MissionPlan& plan) noexcept {
  Route out;
  out.plan_ = &plan;
  out.count_ = std::clamp(plan.waypoint_count, 0, kMaxWaypoints);
  return out;
}

Route Route::back(const FlownPath& path, const Eigen::Vector3d& p_WD, double distance,
                  double speed) noexcept {
  Route out;
  if (!path.known()) return out;
  out.path_ = &path;
  out.from_ = path.joinFrom(p_WD);
  int last = out.from_;
  Eigen::Vector3d start = p_WD;
  double left = distance;
  double length = (path.point(last) - start).norm();
  while (length < left && last > 0) {
    left -= length;
    start = path.point(last--);
    length = (path.point(last) - start).norm();
  }
  out.point_.p_WD = path.point(last);
  out.point_.speed = speed;
  if (length > left) out.point_.p_WD = start + (left / length) * (path.point(last) - start);
  out.count_ = out.from_ - last + 1;
  return out;
}

Route Route::to(const PointTarget& target) noexcept {
  Route out;
  out.point_ = target;
  out.count_ = 1;
  return out;
}

Leg Route::leg(int i) const noexcept {
  if (plan_ != nullptr) {
    const Waypoint& w = plan_->waypoints[static_cast<std::size_t>(i)];
    return {.p_WD = w.p_WD,
            .contact = w.contact,
            .p_WL = w.p_WL,
            .speed = w.speed,
            .hold = w.hold,
            .waypoint = i};
  }
  Leg out{.p_WD = point_.p_WD, .p_WL = point_.p_WL, .speed = point_.speed};
  if (path_ == nullptr) return out;
  out.waypoint = pointOf(i);
  if (i + 1 < count_) out.p_WD = path_->point(out.waypoint);
  if (i > 0) out.contact = path_->contact(out.waypoint + 1);
  return out;
}

ContactStack::Change Route::select(int i, ContactStack& contacts) const noexcept {
  if (plan_ != nullptr)
    return contacts.select(plan_->waypoints[static_cast<std::size_t>(i)].contact, *plan_);
  if (path_ != nullptr && i > 0) return path_->restore(pointOf(i) + 1, contacts);
  return ContactStack::Change::kNone;
}

}  // namespace tautline
