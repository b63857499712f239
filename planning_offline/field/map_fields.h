#pragma once

/// @file
/// Scalar fields of a map that risk elements read, one value a cell, metres (docs/map_fields.md
/// defines each exactly). Not real-time safe: offline only.

#include <vector>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/progress.h"

namespace tautline::planning {

/// Empty vectors were not asked for. Values in cells that are not free are 0.
struct MapFields {
  std::vector<float>
      distance;  ///< Cell centre to the surface of the nearest obstacle cell, exact Euclidean.
  std::vector<float>
      width;  ///< E_cd: narrowest free chord through the cell over the lattice's lines.
  std::vector<float> visibility;  ///< Mean isovist length.
};

struct FieldRequest {
  bool distance{false};
  bool width{false};
  bool visibility{false};
  int visibility_directions{0};  ///< 0 = 98 in space, 64 in the plane.
  double visibility_cap{10.0};   ///< [m]
  double width_cap{10.0};        ///< [m]
  double distance_cap{0.0};      ///< [m]; exact below it, and the cap itself beyond; 0 = no cap.
  bool unknown_is_obstacle{true};
  int threads{0};  ///< 0 = all cores.
};

/// Multi-threaded; the result does not depend on the number of threads. Returns what is complete
/// when cancelled.
[[nodiscard]] MapFields computeFields(const VoxelMap& map, const FieldRequest& request,
                                      const Progress& progress);

}  // namespace tautline::planning
