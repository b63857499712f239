#pragma once

/// @file
/// Paths of our planners as missions to fly, and what is predicted of them: the risk index, and the
/// additive planner's measure to compare it with. Not real-time safe.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/mission/mission_file.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/risk/risk_report.h"

namespace tautline::experiments {

/// What is said of a path before it is flown.
struct Prediction {
  double risk{0.0};      ///< The risk model's: 1 − Π Π (1 − r), in [0, 1].
  double additive{0.0};  ///< Σ of the locale risks of its states, the state-dependent view: >= 0.
  planning::PerElement element_cost{};  ///< Parts of −log(1 − risk).

  /// The additive measure read as a probability without more knowledge: the union bound.
  [[nodiscard]] double additiveRisk() const noexcept { return additive < 1.0 ? additive : 1.0; }
};

/// `points` are in the map, M [m].
[[nodiscard]] Prediction predict(const planning::RiskModel& risk,
                                 const std::vector<Eigen::Vector3d>& points);

/// What is said of a mission in its map. `file` is the mission's, with its reel at that of the map.
/// Throws InputError if it does not fit the map.
[[nodiscard]] Prediction predictMission(const planning::RiskSpace& space, const std::string& file);

struct PlannedPath {
  std::vector<Eigen::Vector3d> points;  ///< Its states, M [m]; empty if there is no path.
  Mission mission;
  Prediction prediction;

  [[nodiscard]] bool found() const noexcept { return !points.empty(); }
};

/// The path of a planner (planning::planners()) from `start` to `goal` [m in M], which are in free
/// cells. The map has a reel with `start` in sight.
[[nodiscard]] PlannedPath planPath(const planning::RiskSpace& space, const std::string& planner,
                                   const Eigen::Vector3d& start, const Eigen::Vector3d& goal);

}  // namespace tautline::experiments
