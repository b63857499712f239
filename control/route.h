#pragma once

/// @file
/// What the motion executor flies: a mission along its waypoints, the way back over what was flown,
/// or a single point. One mechanism for all, so that take-off, hover, return and landing share the
/// mission's checks and time-outs.

#include <optional>

#include <Eigen/Core>

#include "common/mission_plan.h"
#include "control/contact_stack.h"
#include "control/flown_path.h"

namespace tautline {

/// One straight piece of a route.
struct Leg {
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};  ///< Where it ends [m], in W.
  std::optional<int> contact{};  ///< Id active on the way; absent: leave the contact stack alone.
  std::optional<Eigen::Vector3d> p_WL{};  ///< Point to look at [m], in W.
  double speed{0.0};                      ///< [m/s]; 0 = the executor's default.
  double hold{0.0};                       ///< Stay after arrival [s].
  int waypoint{0};  ///< Index of its end in the plan or in the flown path; for a point 0.
};

/// A single target: take-off height, hover point above home, landing, or where the drone is now.
struct PointTarget {
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};  ///< [m] in W.
  double speed{0.0};                              ///< [m/s]; 0 = the executor's default.
  std::optional<Eigen::Vector3d> p_WL{};          ///< Point to look at [m], in W.
};

/// Holds plan and flown path by pointer: the plan must stay as it is for as long as the route is in
/// use, the flown path up to the end of the present leg. Real-time safe throughout: no allocation,
/// no locks, no exceptions.
class Route {
 public:
  /// No legs.
  Route() noexcept = default;

  /// Every waypoint of `plan` in order.
  [[nodiscard]] static Route along(const MissionPlan& plan) noexcept;

  /// From p_WD straight to where it joins `path` and back along it, `distance` [m] in all or to its
  /// beginning. Each leg has the contacts it was flown out with, so that they are undone in
  /// reverse order. No legs if there is no path.
  [[nodiscard]] static Route back(const FlownPath& path, const Eigen::Vector3d& p_WD,
                                  double distance, double speed) noexcept;

  /// One point; the contact stack stays as it is.
  [[nodiscard]] static Route to(const PointTarget& target) noexcept;

  [[nodiscard]] int count() const noexcept { return count_; }

  /// 0 <= i < count().
  [[nodiscard]] Leg leg(int i) const noexcept;

  /// Makes `contacts` what leg i is flown with. 0 <= i < count().
  [[nodiscard]] ContactStack::Change select(int i, ContactStack& contacts) const noexcept;

  /// The plan behind the legs, or nullptr.
  [[nodiscard]] const MissionPlan* plan() const noexcept { return plan_; }

 private:
  /// Index in the flown path of the point that leg i of the way back goes to.
  [[nodiscard]] int pointOf(int i) const noexcept { return from_ - i; }

  const MissionPlan* plan_{nullptr};
  const FlownPath* path_{nullptr};
  int count_{0};
  int from_{0};          ///< Point at which the way back joins the flown path.
  PointTarget point_{};  ///< The single target, or the end of the way back.
};

}  // namespace tautline
