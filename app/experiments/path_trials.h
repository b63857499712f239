#pragma once

/// @file
/// The flights along one path, by law and interval, and their means. Not real-time safe.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "app/experiments/experiment.h"
#include "app/experiments/path_flight.h"

namespace tautline::experiments {

/// Trials of each law at each interval.
struct PathPlan {
  std::string path;
  std::array<std::uint64_t, kPrimitives.size()> trials;
  Duration limit;  ///< Of one flight.
};
[[nodiscard]] std::vector<Trial> pathTrials(const Setup& setup, const PathPlan& plan);

/// One law at one interval, over its trials.
struct PathMeans {
  double interval{0.0};  ///< [m]
  std::size_t flights{0};
  std::size_t completed{0};
  std::string broken_off;  ///< Why the last one that was not completed was broken off.
  double mean{0.0};        ///< Mean of the mean cross-track errors [m].
  double worst{0.0};       ///< Largest of them [m].
  double max{0.0};         ///< Largest cross-track error of all [m].
  double turn{0.0};        ///< [deg]
  double bulge{0.0};       ///< [m]
  double at_axis{0.0};     ///< Longest stay at the axis of all [s].
  std::size_t trapped{0};  ///< Flights that stayed at the axis for longer than kTrapped.
  std::vector<Eigen::Vector3d> track;  ///< Of the first trial.
};
inline constexpr double kTrapped = 14.0;  ///< Twice the way through at 0.1 m/s [s].

/// By Primitive, then by interval.
using PathTable = std::array<std::array<PathMeans, kIntervals.size()>, kPrimitives.size()>;
[[nodiscard]] PathTable pathTable(const PathPlan& plan, const Results& results);
[[nodiscard]] inline const std::array<PathMeans, kIntervals.size()>& of(
    const PathTable& table, Primitive primitive) noexcept {
  return table[static_cast<std::size_t>(primitive)];
}

/// Mean cross-track error at each interval, a published law beside ours; `goal` is ours [m].
[[nodiscard]] std::vector<Row> meanRows(const PathTable& table, Primitive law,
                                        std::optional<double> goal);
/// The table; tracks from above, a panel an interval; mean cross-track error and smoothness
/// against interval.
void addPictures(const Setup& setup, const PathPlan& plan, const PathTable& table,
                 Findings& findings);

/// Sum of one figure over the laws' flights at all intervals.
template <class Member>
[[nodiscard]] double total(const std::array<PathMeans, kIntervals.size()>& means, Member member) {
  double sum = 0.0;
  for (const PathMeans& m : means) sum += static_cast<double>(m.*member);
  return sum;
}

}  // namespace tautline::experiments
