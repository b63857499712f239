#pragma once

/// @file
/// Small mathematics of sampled series, shared by the analysis of a flight. Not real-time safe.

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tautline::report {

/// Summary of a set of numbers; absent where the set was empty.
struct Summary {
  std::size_t count{};
  double mean{};
  double rms{};
  double max{};
  double p95{};  ///< Smallest value that is not exceeded by 95 % of the set (nearest rank).
};
[[nodiscard]] std::optional<Summary> summarize(std::vector<double> values);

/// Slope of the least-squares line through (x, y); absent with fewer than two different x. Same
/// length.
[[nodiscard]] std::optional<double> slope(const std::vector<double>& x,
                                          const std::vector<double>& y);

/// Distance [m] of `p` to the segment from `a` to `b`, ends included; a == b is that point.
[[nodiscard]] double distanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b);

/// A time and a position.
struct PositionSample {
  double t{};
  Eigen::Vector3d p{Eigen::Vector3d::Zero()};
};

/// Linear interpolation in a series sorted by time. Absent before its first and after its last
/// sample, and inside a hole longer than `max_gap` [s]: a position is never invented.
[[nodiscard]] std::optional<Eigen::Vector3d> interpolate(const std::vector<PositionSample>& series,
                                                         double t, double max_gap);

/// How often the sign changes from one value beyond the dead band (|v| > dead_band) to the next
/// such value.
[[nodiscard]] int countSignChanges(const std::vector<double>& values, double dead_band);

}  // namespace tautline::report
