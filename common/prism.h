#pragma once

/// @file
/// Solid upright prism over a simple polygon in the floor plane: distance to it, and the part of a
/// straight line inside it. Corners are (z, x), any orientation, not necessarily convex, not
/// closed. Real-time safe: no allocation, no locks, no exceptions; work is bounded by the square of
/// the number of corners.

#include <optional>
#include <span>

#include <Eigen/Core>

namespace tautline {

/// Does not own its corners.
struct PrismView {
  std::span<const Eigen::Vector2d> footprint;
  double y_min{0.0};
  double y_max{0.0};
};

/// The part p + t (q - p), t_in <= t <= t_out in [0, 1], of a line from p to q that is inside an
/// obstacle.
struct SegmentHit {
  double t_in{0.0};
  double t_out{0.0};
};

/// Cuts [hit.t_in, hit.t_out] down to where lo < p + t d < hi. False if nothing is left.
[[nodiscard]] bool clip(double p, double d, double lo, double hi, SegmentHit& hit) noexcept;

/// First stretch of the line p-q in the interior of the prism, or nothing. Merely touching a face
/// or an edge is no hit.
[[nodiscard]] std::optional<SegmentHit> intersect(const Eigen::Vector3d& p,
                                                  const Eigen::Vector3d& q,
                                                  const PrismView& prism) noexcept;

/// Distance from a point to the surface [m], negative inside.
[[nodiscard]] double signedDistance(const Eigen::Vector3d& p, const PrismView& prism) noexcept;

/// A point of space in the floor plane, in the order of a footprint's corners.
[[nodiscard]] inline Eigen::Vector2d floorPoint(const Eigen::Vector3d& p) noexcept {
  return {p.z(), p.x()};
}

/// z component of a x b.
[[nodiscard]] inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) noexcept {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace tautline
