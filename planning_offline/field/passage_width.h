#pragma once

/// @file
/// E_cd, the characteristic dimension of the work envelope (dissertation, section "Scale of
/// Characteristic Dimension"): how wide the narrowest passage through a place is. Not real-time
/// safe: offline only.

#include <cstdint>
#include <span>
#include <vector>

#include "planning_offline/field/parallel.h"
#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

struct WidthOptions {
  double resolution{1.0};    ///< Edge of a cell [m].
  double cap{10.0};          ///< Widest that is told apart [m].
  bool solid_border{false};  ///< Chords end at the map's border; else one that leaves the map is as
                             ///< long as the cap.
  int threads{0};            ///< 0 = all cores.
};

/// One value a cell [m], 0 in obstacles: the shortest of the free chords through the cell's centre
/// along the lattice's 13 lines (3 axes, 6 face and 4 space diagonals; 4 lines in the plane). A
/// chord of m cells is m steps long. `obstacles`: one byte a cell, 0 = free. Empty if cancelled.
[[nodiscard]] std::vector<float> widthField(const GridShape& shape,
                                            std::span<const std::uint8_t> obstacles,
                                            const WidthOptions& options, const Progress& progress,
                                            const Stage& stage);

}  // namespace tautline::planning
