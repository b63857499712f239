#pragma once

/// @file
/// Flies a waypoint path with law, executor and kinematic plant, and measures it. Tests only.

#include <vector>

#include <Eigen/Core>

#include "control/control_config.h"
#include "control/motion_executor.h"
#include "control/test/kinematic_plant.h"

namespace tautline::testing {

using Path = std::vector<Eigen::Vector3d>;

/// The two published test paths (dissertation section 6.2), corners only.
[[nodiscard]] Path path1();
[[nodiscard]] Path path2();

/// The published way-point intervals [m]: along the horizontal of path 1, along each axis of
/// path 2.
inline constexpr double kIntervals[] = {0.2, 0.5, 1.0, 1.5, 3.0};

/// `corners` with way points every `interval` [m] (measured along the longest axis of each piece).
[[nodiscard]] Path densify(const Path& corners, double interval);

struct FlightPlan {
  Path waypoints;
  double speed{0.3};
  ControlConfig control;
  Controller* other_law{nullptr};  ///< Flies instead of control's, if set.
  ExecutorConfig executor;
  PlantConfig plant;
  Eigen::Vector3d p_WC{Eigen::Vector3d::Zero()};  ///< Not zero: all of it hangs from this contact.
  unsigned seed{1};
  double time_limit{180.0};
};

struct FlightRecord {
  bool finished{false};
  MissionFailure failure{MissionFailure::kNone};
  double time{0.0};        ///< [s]
  double mean_error{0.0};  ///< Mean over time of the true distance to the path [m].
  double max_error{0.0};   ///< [m]
  double near_axis{0.0};   ///< Time within 0.35 m of the axis through the anchor [s].

  /// Caught at the pole: more than 20 s there, or not through in time.
  [[nodiscard]] bool trapped() const { return !finished || near_axis > 20.0; }
};

[[nodiscard]] FlightRecord fly(const FlightPlan& plan);

/// Executor as published: 0.4 m acceptance radius and nothing else. Gives up late, so that traps
/// show.
[[nodiscard]] ExecutorConfig publishedExecutor(double acceptance = 0.4);

}  // namespace tautline::testing
