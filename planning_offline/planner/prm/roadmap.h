#pragma once

/// @file
/// A probabilistic roadmap (Kavraki and Latombe, 1994) over the cells of a map, grown by OMPL. Not
/// real-time safe: offline only.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/progress.h"

namespace tautline::planning {

struct RoadmapSettings {
  std::size_t milestones{2000};      ///< Grown to at least so many,
  std::size_t milestones_max{8000};  ///< and on to so many until what must be connected is.
  std::size_t connected{0};          ///< So many of the wanted cells must be, the first ones.
  std::uint64_t seed{1};
};

struct Roadmap {
  struct Edge {
    std::size_t to{0};   ///< Index of a milestone.
    double length{0.0};  ///< In cells.
  };
  std::vector<CellIndex> milestones;     ///< Those that have an edge, ascending.
  std::vector<std::vector<Edge>> edges;  ///< One list a milestone.

  /// Shortest ways from one cell to all milestones.
  struct Tree {
    std::vector<double> length;     ///< In cells; infinite where no way leads.
    std::vector<std::size_t> from;  ///< Milestone before; itself at the root.
  };
  /// Index of a cell's milestone; milestones.size() if it is none.
  [[nodiscard]] std::size_t indexOf(CellIndex cell) const;
  [[nodiscard]] Tree shortestFrom(std::size_t root) const;
};

/// Milestones are centres of allowed cells: all of `wanted` (allowed, distinct) and then cells in
/// random order, none twice. Each is linked to its nearest ones that a straight line reaches
/// through allowed cells only. The same for the same seed, whatever else uses OMPL. Returns what
/// there is when cancelled.
[[nodiscard]] Roadmap growRoadmap(const GridShape& shape, const std::vector<std::uint8_t>& allowed,
                                  const std::vector<CellIndex>& wanted,
                                  const RoadmapSettings& settings, const Progress& progress);

}  // namespace tautline::planning
