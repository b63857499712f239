#pragma once

/// @file
/// Way-finding for clearance alone, a problem that sampling planners and the lattice can both
/// solve: the cost of a path is the integral of a rate that falls with the distance to obstacles.

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/lattice.h"
#include "planning_offline/risk/risk_model.h"

namespace tautline::planning {

/// Points of a path in cells: (p_M − origin) / resolution.
using CellPoints = std::vector<Eigen::Vector3d>;

class ClearanceProblem {
 public:
  explicit ClearanceProblem(VoxelMap map);

  [[nodiscard]] const Lattice& lattice() const noexcept { return *lattice_; }
  [[nodiscard]] const Eigen::Vector3d& start() const noexcept { return start_; }
  [[nodiscard]] const Eigen::Vector3d& goal() const noexcept { return goal_; }

  [[nodiscard]] bool free(const Eigen::Vector3d& p) const;
  [[nodiscard]] bool sees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;
  /// Integral of the rate along a straight line: midpoints of pieces of half a cell, each with the
  /// rate of the cell that holds it. The one judge of all planners.
  [[nodiscard]] double cost(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;
  [[nodiscard]] double cost(const CellPoints& path) const;

  /// The least-risk tree of the lattice, its path to the goal, and straight lines where they are
  /// cheaper.
  [[nodiscard]] CellPoints solve() const;

 private:
  void choosePlaces();
  [[nodiscard]] CellPoints shortcut(const CellPoints& path) const;
  [[nodiscard]] Eigen::Vector3d centre(CellIndex i) const;
  [[nodiscard]] CellIndex cellAt(const Eigen::Vector3d& p) const;

  std::unique_ptr<RiskModel> model_;
  std::unique_ptr<Lattice> lattice_;
  std::vector<std::uint8_t> blocked_;
  std::vector<float> rate_;  ///< Per cell length, one a cell.
  Eigen::Vector3d start_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d goal_{Eigen::Vector3d::Zero()};
};

}  // namespace tautline::planning
