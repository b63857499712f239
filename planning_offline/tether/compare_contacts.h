#pragma once

/// @file
/// The dissertation's contact planner (published_contacts.h) beside the taut string (taut_string.h)
/// over one path, waypoint by waypoint. docs/contact_comparison.md. Not real-time safe: offline
/// only.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/contact_plan.h"
#include "planning_offline/tether/published_contacts.h"

namespace tautline::planning {

/// One waypoint by both.
struct ContactRow {
  TetherState published;
  TetherState exact;
};

struct ContactComparison {
  std::vector<ContactRow> rows{};  ///< One a waypoint.
  /// Moves for which the taut string found none outside all obstacles (TautString): not zero if the
  /// path goes through one.
  std::int64_t unresolved_moves{0};
};

/// The taut string comes to the first waypoint straight from the reel. Throws InputError like
/// publishedContacts().
[[nodiscard]] ContactComparison compareContacts(const VoxelMap& map, const Eigen::Vector3d& reel,
                                                std::span<const Eigen::Vector3d> path,
                                                const PublishedOptions& options = {});

/// Waypoints where the published tether was not relaxed though the line was free.
[[nodiscard]] std::ptrdiff_t countRefused(const ContactComparison& comparison);
/// Waypoints where it goes through an obstacle.
[[nodiscard]] std::ptrdiff_t countPierced(const ContactComparison& comparison);
/// Largest difference of the two tether lengths at a waypoint [m].
[[nodiscard]] double largestDifference(const ContactComparison& comparison);

}  // namespace tautline::planning
