#pragma once

/// @file
/// Where a point is relative to a straight path segment. Any frame; [m].

#include <Eigen/Core>

namespace tautline {

/// Projection of a point on the segment S to E.
struct SegmentProgress {
  Eigen::Vector3d direction{
      Eigen::Vector3d::Zero()};  ///< Unit vector S to E; zero for a segment without length.
  Eigen::Vector3d closest{
      Eigen::Vector3d::Zero()};  ///< Point of the segment closest to the given one.
  double length{0.0};            ///< |SE|
  double along{0.0};             ///< Signed way along the segment's line from S; > length beyond E.
  double off_line{0.0};          ///< Distance to the unbounded line.
  double cross_track{0.0};       ///< Distance to the segment, i.e. to `closest`.
};

/// Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] inline SegmentProgress projectOnSegment(const Eigen::Vector3d& p,
                                                      const Eigen::Vector3d& start,
                                                      const Eigen::Vector3d& end) noexcept {
  constexpr double kNoLength = 1e-9;
  SegmentProgress out;
  out.length = (end - start).norm();
  if (out.length > kNoLength) out.direction = (end - start) / out.length;
  out.along = out.direction.dot(p - start);
  out.off_line = (p - start - out.along * out.direction).norm();
  const double inside = out.along < 0.0 ? 0.0 : (out.along > out.length ? out.length : out.along);
  out.closest = start + inside * out.direction;
  out.cross_track = (p - out.closest).norm();
  return out;
}

}  // namespace tautline
