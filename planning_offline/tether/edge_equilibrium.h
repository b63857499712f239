#pragma once

/// @file
/// Where a string that bends round given edges comes to rest: the shortest line from one end over
/// one point of each edge to the other end. A convex problem: there is one answer. All lengths in
/// cells. Not real-time safe: offline only.

#include <span>
#include <vector>

#include <Eigen/Core>

namespace tautline::planning {

/// A stretch of a line along one axis.
struct SlidingPoint {
  Eigen::Vector3d at;  ///< A point of it: where the search begins, then the answer.
  int axis;
  double low;  ///< Of the component along the axis, low <= high.
  double high;
};

/// Moves each point along its stretch to where the line a – points – b is shortest, to about 1e-9
/// of its length. At most 60 Newton steps, each of which makes the line no longer: where they do
/// not suffice the points stay where the last one left them, on their stretches.
void findEquilibrium(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                     std::span<SlidingPoint> points);

/// How fast the length of a – at – b grows with the point's way along the axis, in [−2, 2].
[[nodiscard]] double slope(const Eigen::Vector3d& a, const Eigen::Vector3d& at, int axis,
                           const Eigen::Vector3d& b) noexcept;

}  // namespace tautline::planning
