#pragma once

/// @file
/// From what a map file says about regions of space to the cells of a VoxelMap. A cell takes the
/// worst state of all regions that meet its interior: occupied before unknown before free.
/// Coordinates in M [m]; edges nearer to each other than 1e-6 of a cell count as equal, so that
/// 3 · 0.1 and 0.3 are the same place. Not real-time safe: offline only.

#include <string>

#include <Eigen/Core>

#include "common/fields.h"
#include "planning_offline/map/load_map.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

inline constexpr Range kResolutionRange{0.001, 1000.0};  ///< Edge of a cell [m].

/// A map file before crop and slice.
struct MapSource {
  std::string file;        ///< As in errors.
  Bounds extent;           ///< The grid starts at its lower corner and covers it all.
  double resolution{1.0};  ///< Edge of a cell [m], in kResolutionRange.
  bool resampled{true};    ///< A larger cell means fewer cells.
  std::size_t bytes_per_cell{1};
  double other_bytes{0.0};  ///< Held while the map is made.
};

/// A map of free cells: the grid over the extent, of which crop and slice keep their part. The last
/// cells may reach beyond the extent. Throws InputError before it allocates: crop or slice outside,
/// too much memory.
[[nodiscard]] VoxelMap makeMap(const MapSource& source, const LoadOptions& options);

/// Throws InputError if more is needed than the limit [bytes].
void checkMemory(const std::string& file, const std::string& what, double needed,
                 std::int64_t limit, const std::string& remedy);

/// Block of cells, both corners included; empty if lo > hi in any component.
struct CellRange {
  Eigen::Vector3i lo{Eigen::Vector3i::Zero()};
  Eigen::Vector3i hi{Eigen::Vector3i::Constant(-1)};
};

/// Cells whose interior meets the interior of the box. Bounds may be infinite.
[[nodiscard]] CellRange cellsMeeting(const VoxelMap& map, const Bounds& box);

/// Cells whose centre is in the closed box.
[[nodiscard]] CellRange cellsCentredIn(const VoxelMap& map, const Bounds& box);

/// Calls f(index of the cell) for each cell of the range, ascending.
template <class Function>
void forEachCell(const GridShape& shape, const CellRange& range, Function f) {
  for (int z = range.lo.z(); z <= range.hi.z(); ++z) {
    for (int y = range.lo.y(); y <= range.hi.y(); ++y) {
      for (int x = range.lo.x(); x <= range.hi.x(); ++x) f(shape.index({x, y, z}));
    }
  }
}

/// Gives all cells that meet the box this state, unless theirs is worse.
void mark(VoxelMap& map, const Bounds& box, CellState state);

/// mark() for all space outside the box.
void markOutside(VoxelMap& map, const Bounds& box, CellState state);

/// The occupied cells of the range become such that the tether must not touch.
void forbidContact(VoxelMap& map, const CellRange& range);

/// From the lower corner of the first cell to the upper corner of the last.
[[nodiscard]] Bounds boundsOf(const VoxelMap& map);

}  // namespace tautline::planning
