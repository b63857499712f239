#pragma once

/// @file
/// Visibility of a place: mean length of the isovist lines around it (dissertation, section
/// "Visibility"; Benedikt, 1979). Not real-time safe: offline only.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/field/parallel.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

inline constexpr int kIsovistDirections = 98;        ///< In space.
inline constexpr int kIsovistDirectionsPlanar = 64;  ///< In the plane.

/// Unit vectors, evenly spread, each with its opposite right behind it. In the plane: equal angles
/// in zx, none along an axis or diagonal. In space: a Fibonacci spiral over the half sphere and its
/// mirror image. An odd count is rounded up.
[[nodiscard]] std::vector<Eigen::Vector3d> isovistDirections(int count, bool planar);

/// Length of a ray in the unit that sums are exact in: cap / kIsovistUnits, rounded to nearest.
inline constexpr int kIsovistUnits = 65535;
[[nodiscard]] std::uint32_t isovistUnits(double length, double cap) noexcept;

/// A ray enters another cell: offset from the cell that it starts in, and where on the ray.
struct RayStep {
  Eigen::Vector3i offset;
  double length;  ///< [cells]
};

/// The cells that a ray from a cell's centre enters before it is `length` cells long, in order.
/// Through an edge or corner it enters the diagonal neighbour only. The same for all cells.
[[nodiscard]] std::vector<RayStep> raySteps(const Eigen::Vector3d& direction, double length);

struct IsovistOptions {
  double resolution{1.0};  ///< Edge of a cell [m].
  int directions{0};       ///< 0 = 98 in space, 64 in the plane; at most 65536.
  double cap{10.0};        ///< No ray counts for more [m].
  int threads{0};          ///< 0 = all cores.
};

/// One value a cell [m], 0 in obstacles. A ray ends where it enters an obstacle cell or leaves the
/// map. `obstacles`: one byte a cell, 0 = free. Empty if cancelled.
///
/// The steps of one direction are the same for all cells. So which rays of that direction are still
/// free after a step is, for all cells at once, the map of free cells shifted by the step's offset:
/// bit rows, 128 to 512 cells an instruction. Lengths are added up as bit planes.
[[nodiscard]] std::vector<float> isovistField(const GridShape& shape,
                                              std::span<const std::uint8_t> obstacles,
                                              const IsovistOptions& options,
                                              const Progress& progress, const Stage& stage);

}  // namespace tautline::planning
