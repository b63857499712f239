#pragma once

/// @file
/// What the motion executor flies: a mission along its waypoints, the flown part of one back again,
/// or a single point. One mechanism for all, so that take-off, hover, return and landing share the
/// mission's checks and time-outs.

#include <optional>

#include <Eigen/Core>

#include "common/mission_plan.h"

namespace tautline {

/// One straight piece of a route.
struct Leg {
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};  ///< Where it ends [m], in W.
  std::optional<int> contact{};  ///< Id active on the way; absent: leave the contact stack alone.
  std::optional<Eigen::Vector3d> p_WL{};  ///< Point to look at [m], in W.
  double speed{0.0};                      ///< [m/s]; 0 = the executor's default.
  double hold{0.0};                       ///< Stay after arrival [s].
  int waypoint{0};                        ///< Index in the plan, for telemetry.
};

/// A single target: take-off height, hover point above home, landing, or where the drone is now.
struct PointTarget {
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};  ///< [m] in W.
  double speed{0.0};                              ///< [m/s]; 0 = the executor's default.
  std::optional<Eigen::Vector3d> p_WL{};          ///< Point to look at [m], in W.
};

/// Holds the plan by pointer: it must stay as it is for as long as the route is in use.
/// Real-time safe throughout: no allocation, no locks, no exceptions.
class Route {
 public:
  /// No legs.
  Route() noexcept = default;

  /// Every waypoint of `plan` in order.
  [[nodiscard]] static Route along(const MissionPlan& plan) noexcept;

  /// Back from the leg towards waypoint `from` over the waypoints before it to `p_WStart`, where
  /// the drone was before waypoint 0. Each leg has the contact it was flown out with, so that
  /// contacts are undone in reverse order. Without looks and holds.
  [[nodiscard]] static Route back(const MissionPlan& plan, int from,
                                  const Eigen::Vector3d& p_WStart) noexcept;

  /// One point; the contact stack stays as it is.
  [[nodiscard]] static Route to(const PointTarget& target) noexcept;

  [[nodiscard]] int count() const noexcept { return count_; }

  /// 0 <= i < count().
  [[nodiscard]] Leg leg(int i) const noexcept;

  /// The plan's own leg that leg i flies or undoes; 0 for a single point. 0 <= i < count().
  [[nodiscard]] int outwardLeg(int i) const noexcept { return backwards_ ? count_ - 1 - i : i; }

  /// The plan behind the legs, or nullptr.
  [[nodiscard]] const MissionPlan* plan() const noexcept { return plan_; }

 private:
  const MissionPlan* plan_{nullptr};
  int count_{0};
  bool backwards_{false};
  PointTarget point_{};  ///< The single target, or the start that the way back ends at.
};

}  // namespace tautline
