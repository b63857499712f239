#pragma once

/// @file
/// Shortest paths on a lattice where a step costs its length. Not real-time safe: offline only.

#include <cstdint>
#include <optional>
#include <vector>

#include "planning_offline/map/lattice.h"
#include "planning_offline/progress.h"

namespace tautline::planning {

/// Length of the shortest way between two cells of an empty lattice without border [cells]: as many
/// steps over vertices as possible, then over edges, then over faces (the octile distance in three
/// dimensions), as far as the connectivity has them.
[[nodiscard]] double octileDistance(const Eigen::Vector3i& a, const Eigen::Vector3i& b,
                                    Connectivity connectivity) noexcept;

/// A* (Hart, Nilsson, Raphael, 1968) with the octile distance as its bound, which is consistent.
/// Keeps its memory from search to search, 28 bytes a cell. The lattice must outlive it.
class ShortestPath {
 public:
  explicit ShortestPath(const Lattice& lattice);

  /// Length of the shortest path [cells]; nothing if start or goal is not free, there is no path,
  /// or the search was cancelled. Start and goal must be cells of the lattice. Deterministic. The
  /// length is counted in steps of each kind, so it does not depend on the order they come in.
  [[nodiscard]] std::optional<double> length(CellIndex start, CellIndex goal,
                                             const Progress& progress);

 private:
  /// What is known of a cell; valid if `search` is the current search's number.
  struct Label {
    double cost{0.0};
    std::uint32_t search{0};
    CellIndex from{kNoCell};
    bool settled{false};
  };

  double countedLength(CellIndex start, CellIndex goal) const;

  const Lattice& lattice_;
  std::vector<Label> labels_;
  std::uint32_t search_{0};
};

}  // namespace tautline::planning
