#pragma once

/// @file
/// Exact Euclidean distance from the centre of each cell to the surface of the nearest obstacle
/// cell. Not real-time safe: offline only.
///
/// Between two cells the gap along one axis is 0 in the same column, else |Δ| − ½ cells: a convex
/// function of Δ, so the squared distance is found axis by axis like Felzenszwalb and
/// Huttenlocher's (2012) transform. In half cells the gaps are the odd integers, and the whole
/// computation is exact in integers. In place of their lower envelope each cell looks ever further
/// to both sides until no farther sample can win; whole vectors of cells do so together, and the
/// way they look is the distance itself.

#include <cstdint>
#include <span>
#include <vector>

#include "planning_offline/field/parallel.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

struct DistanceOptions {
  double resolution{1.0};    ///< Edge of a cell [m].
  double cap{0.0};           ///< [m]; exact below it, the cap itself beyond; 0 = no cap.
  bool solid_border{false};  ///< All that lies outside the map is an obstacle; of a planar map,
                             ///< what lies beside it, not above and below.
  int threads{0};            ///< 0 = all cores.
};

/// One value a cell [m], 0 in obstacles. `obstacles`: one byte a cell, 0 = free. Without any
/// obstacle and without a cap: the length of the map's diagonal. Exact up to 16383 cells. Empty if
/// cancelled.
[[nodiscard]] std::vector<float> distanceField(const GridShape& shape,
                                               std::span<const std::uint8_t> obstacles,
                                               const DistanceOptions& options,
                                               const Progress& progress, const Stage& stage);

}  // namespace tautline::planning
