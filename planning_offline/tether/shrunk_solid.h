#pragma once

/// @file
/// The obstacles of a map, shrunk by about 1e-6 of a cell. A string that just touches them is free,
/// and since every plane of faces moves by its own amount no two events of a string's sweep
/// coincide, save those that one plane makes coincide. Lengths in cells. Not real-time safe:
/// offline only.
///
/// Exactly: all faces in plane k across an axis that look the same way move into their cells by the
/// same amount, 0.5e-6 … 1.5e-6, a fixed function of axis, k and side. So the planes of the grid
/// are doubled, with a thin slab, the joint, in between, and the solid is a map on that finer grid:
/// a cell of a joint is solid if all the cells that it joins are occupied.

#include <array>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/convex_edges.h"
#include "planning_offline/tether/near_field.h"

namespace tautline::planning {

/// The stretch of an edge that a contact can slide along, and whether it slips off at the ends: the
/// obstacle ends there. If it does not, another one stands in the way.
struct EdgeRun {
  double low{0.0};
  double high{0.0};
  bool slips_low{false};
  bool slips_high{false};
};

class ShrunkSolid {
 public:
  static constexpr double kShrinkMax = 1.5e-6;

  /// Keeps a copy of the cells.
  explicit ShrunkSolid(const VoxelMap& map);

  /// Convex edges along an axis; quadrants() as in the map.
  [[nodiscard]] const ConvexEdges& edges(int axis) const noexcept {
    return edges_[static_cast<std::size_t>(axis)];
  }

  /// Where an edge is, as (u, v).
  [[nodiscard]] Eigen::Vector2d across(const ConvexEdge& edge) const noexcept {
    return {plane(axisU(edge.axis), edge.u, edge.sideU() > 0),
            plane(axisV(edge.axis), edge.v, edge.sideV() > 0)};
  }

  /// The point of an edge at `w` along it.
  [[nodiscard]] Eigen::Vector3d pointOn(const ConvexEdge& edge, double w) const noexcept {
    const Eigen::Vector2d uv = across(edge);
    Eigen::Vector3d point;
    point[axisU(edge.axis)] = uv.x();
    point[axisV(edge.axis)] = uv.y();
    point[edge.axis] = w;
    return point;
  }

  /// True if there is a convex edge of this line at `w` along it, to stop a string that moves in a
  /// plane with this normal (any length).
  [[nodiscard]] bool has(const ConvexEdge& edge, double w,
                         const Eigen::Vector3d& normal) const noexcept;

  /// The run of a convex edge around `w`, where it must be convex (has()).
  [[nodiscard]] EdgeRun runAround(const ConvexEdge& edge, double w) const noexcept;

  /// A convex edge that ends at a corner of the solid, and to which side of it along its axis it
  /// lies.
  struct EdgeEnd {
    ConvexEdge edge;
    int side;  ///< −1 or +1
  };
  /// Those that end within 1e-7 of a point.
  [[nodiscard]] std::vector<EdgeEnd> edgesFrom(const Eigen::Vector3d& corner) const;

  /// Where edges and cells are near a string.
  [[nodiscard]] const NearField& field() const noexcept { return field_; }

  /// True if the straight line goes deeper than `kDepthMax` below the obstacles' true surface. What
  /// is shorter than 1e-4 in a cell is not looked at: there the line cuts a corner. `near` says
  /// where it may be near occupied cells, 0 at a and 1 at b.
  [[nodiscard]] bool penetrated(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Stretches& near) const noexcept;
  static constexpr double kDepthMax = 1e-5;

 private:
  /// Where the faces of the cells above or below a grid plane are.
  [[nodiscard]] double plane(int axis, int k, bool above) const noexcept {
    return planes_[static_cast<std::size_t>(axis)]
                  [2 * static_cast<std::size_t>(k) + (above ? 1 : 0)];
  }
  [[nodiscard]] bool occupied(const Eigen::Vector3i& cell) const noexcept {
    return shape_.contains(cell) &&
           cells_[static_cast<std::size_t>(shape_.index(cell))] == CellState::kOccupied;
  }
  /// True if the cell in the edge's quadrant is occupied in slab w.
  [[nodiscard]] bool solid(const ConvexEdge& edge, int w) const noexcept;
  /// The solid along an edge is made of layers: 2k + 1 is slab k, 2k the joint below it.
  [[nodiscard]] int layerAt(int axis, double w) const noexcept;
  [[nodiscard]] double layerEnd(int axis, int layer) const noexcept;  ///< Its upper end.
  [[nodiscard]] bool convexIn(const ConvexEdge& edge, int layer) const noexcept;
  [[nodiscard]] bool solidIn(const ConvexEdge& edge, int layer) const noexcept;
  /// penetrated() for a line that is near cells all along.
  [[nodiscard]] bool penetratedAnywhere(const Eigen::Vector3d& a,
                                        const Eigen::Vector3d& b) const noexcept;
  /// How far a point is inside the obstacles, by the largest component of the way out; at most 1.
  [[nodiscard]] double depth(const Eigen::Vector3d& p) const noexcept;

  GridShape shape_;
  std::vector<CellState> cells_;
  std::array<ConvexEdges, 3> edges_;
  std::array<std::vector<double>, 3> planes_;  ///< Two a grid plane: below, above.
  NearField field_;
};

}  // namespace tautline::planning
