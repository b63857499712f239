#pragma once

/// @file
/// Moves between neighbouring cells. A direction is one of the 26 steps (dx, dy, dz) in {-1, 0,
/// 1}^3 \ {0}, numbered 0 … 25 so that 25 - d is the opposite of d. Diagonal steps never cut
/// corners: all cells of the box that the step spans must be free. Not real-time safe: offline
/// only.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/fields.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

inline constexpr int kDirections = 26;
inline constexpr int kNoDirection = 26;  ///< Of a path that has not moved yet.
using Direction = int;

/// Which neighbours a cell has: over faces (6; 4 in the plane), also over edges (18; 8 in the
/// plane), also over vertices (26; 8 in the plane).
enum class Connectivity : std::uint8_t { kFaces, kEdges, kVertices };
inline constexpr std::array<EnumName<Connectivity>, 3> kConnectivityNames{
    {{Connectivity::kFaces, "faces"},
     {Connectivity::kEdges, "edges"},
     {Connectivity::kVertices, "vertices"}}};

[[nodiscard]] constexpr Direction opposite(Direction d) noexcept { return kDirections - 1 - d; }

/// The step of a direction in cells.
[[nodiscard]] const Eigen::Vector3i& stepOf(Direction d) noexcept;

/// Direction of a step between neighbours; the step must not be zero and within {-1, 0, 1}^3.
[[nodiscard]] Direction directionOf(const Eigen::Vector3i& step) noexcept;

/// Length of a step in cells: 1, √2 or √3.
[[nodiscard]] double stepLength(Direction d) noexcept;

/// Directions of this connectivity, ascending; without those along y if the map is planar.
[[nodiscard]] std::vector<Direction> directionsOf(Connectivity connectivity, bool planar);

/// Where the vehicle may be, and the moves it may make from each cell: a bit mask of directions a
/// cell, corner cutting and the map's border already taken into account. Four bytes a cell.
class Lattice {
 public:
  /// `free`: one byte a cell, 0 = not allowed.
  Lattice(GridShape shape, Connectivity connectivity, std::vector<std::uint8_t> free);

  [[nodiscard]] const GridShape& shape() const noexcept { return shape_; }
  [[nodiscard]] Connectivity connectivity() const noexcept { return connectivity_; }
  [[nodiscard]] std::span<const Direction> directions() const noexcept { return directions_; }
  [[nodiscard]] bool free(CellIndex i) const noexcept {
    return free_[static_cast<std::size_t>(i)] != 0;
  }
  [[nodiscard]] std::span<const std::uint8_t> freeCells() const noexcept { return free_; }
  [[nodiscard]] std::size_t freeCount() const noexcept { return free_count_; }
  /// Bit d is set if the step in direction d is allowed. Zero for a cell that is not free.
  [[nodiscard]] std::uint32_t moves(CellIndex i) const noexcept {
    return moves_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] CellIndex neighbour(CellIndex i, Direction d) const noexcept {
    return i + offset_[static_cast<std::size_t>(d)];
  }

 private:
  GridShape shape_;
  Connectivity connectivity_;
  std::vector<Direction> directions_;
  std::array<CellIndex, kDirections> offset_{};
  std::vector<std::uint8_t> free_;
  std::vector<std::uint32_t> moves_;
  std::size_t free_count_{0};
};

}  // namespace tautline::planning
