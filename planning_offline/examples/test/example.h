#pragma once

/// @file
/// The shipped examples, loaded as `tautline-plan` loads them. Paths are relative to config/.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/lattice.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/planner/planner.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning {

/// Map, moves and risk of one example.
struct Example {
  std::shared_ptr<const VoxelMap> map;
  std::unique_ptr<Lattice> lattice;
  std::unique_ptr<RiskModel> risk;

  /// Index of the cell that holds a point; the test stops if it is not free.
  [[nodiscard]] CellIndex cellAt(const Eigen::Vector3d& p) const;

  /// With the map's start and rewards; `start` overrides.
  [[nodiscard]] PlanProblem problem(std::optional<Eigen::Vector3d> start = {}) const;

  /// Plan to a goal with default options.
  [[nodiscard]] PlanResult planTo(const char* planner, const Eigen::Vector3d& goal) const;
};

[[nodiscard]] Example loadExample(const std::string& map, const std::string& params,
                                  Connectivity connectivity);

/// Centre of each cell of a path, M [m].
[[nodiscard]] std::vector<Eigen::Vector3d> pointsOf(const Example& example,
                                                    const std::vector<CellIndex>& path);

}  // namespace tautline::planning
