#pragma once

/// @file
/// Cuts a simple polygon into convex pieces: ears first, then neighbouring pieces are merged while
/// the result stays convex (Hertel and Mehlhorn 1983: at most four times the least number of
/// pieces). Not real-time safe: start-up only.

#include <vector>

#include <Eigen/Core>

namespace tautline::sim {

struct ConvexPiece {
  std::vector<Eigen::Vector2d> corner;  ///< Counter-clockwise.
  std::vector<bool> inner;              ///< Side i to i+1 is a cut, not a side of the polygon.
};

/// `polygon` is simple, in any orientation, not closed.
[[nodiscard]] std::vector<ConvexPiece> convexPieces(std::vector<Eigen::Vector2d> polygon);

}  // namespace tautline::sim
