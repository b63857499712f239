#pragma once

/// @file
/// The taut string in the plane: exact and frictionless. Not real-time safe: offline only.
///
/// Seen from above, axis u is z and v is x, so that positive turns are counter-clockwise. Points
/// are rounded to 1/1024 of a cell; all decisions are signs of integer cross products. A stack
/// holds strictly turning contacts only, which makes it a function of the homotopy class of the
/// path and the position: a string that just touches a corner is straight. docs/taut_string.md.

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/convex_edges.h"
#include "planning_offline/tether/tree_string.h"

namespace tautline::planning {

class PlanarString final : public TreeString {
 public:
  /// The map must be planar. The reel is taken into the middle of the plane. Throws InputError if
  /// it may not stand there (checkedReel()).
  PlanarString(const VoxelMap& map, const Eigen::Vector3d& reel);

  /// Points of a move must be finite and within kFarthest of the map's origin.
  [[nodiscard]] StackId move(StackId stack, const Eigen::Vector3d& from,
                             const Eigen::Vector3d& to) override;

 private:
  /// Point or vector (u, v) in 1/1024 cells.
  using Fine = Eigen::Matrix<std::int64_t, 2, 1>;

  /// A corner that the string meets first while it turns about the anchor.
  struct Corner {
    Fine point;
    ConvexEdge edge;
  };

  [[nodiscard]] Fine fine(const Eigen::Vector3d& p_M) const;
  [[nodiscard]] Fine anchorOf(StackId stack) const;
  [[nodiscard]] StackId push(StackId stack, const Corner& corner, int turn);

  /// First corner that the string from `a` meets while its end goes from p to q and the string
  /// turns from direction `ray` in the sense `turn` (+1, −1).
  [[nodiscard]] std::optional<Corner> firstCorner(const Fine& a, const Fine& ray, const Fine& p,
                                                  const Fine& q, int turn) const;

  Eigen::Vector3d origin_;
  double resolution_;
  ConvexEdges corners_;
  Fine reel_;
};

}  // namespace tautline::planning
