#pragma once

/// @file
/// The dissertation's contact planner (published_contacts.h) beside the taut string (taut_string.h)
/// over one path, waypoint by waypoint. docs/contact_comparison.md. Not real-time safe: offline
/// only.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/published_contacts.h"

namespace tautline::planning {

/// One waypoint. Points in M [m].
struct ContactRow {
  Eigen::Vector3d waypoint;
  PublishedState published;
  double published_length{0.0};        ///< Reel, contacts, waypoint [m].
  std::vector<Eigen::Vector3d> exact;  ///< Contacts of the taut string, from the reel.
  double exact_length{0.0};            ///< Of the taut string [m].
};

struct ContactComparison {
  std::vector<ContactRow> rows;  ///< One a waypoint.
  /// Moves for which the taut string found none outside all obstacles (TautString): not zero if the
  /// path goes through one.
  std::int64_t unresolved_moves{0};
};

/// The taut string comes to the first waypoint straight from the reel. Throws InputError like
/// publishedContacts().
[[nodiscard]] ContactComparison compareContacts(const VoxelMap& map, const Eigen::Vector3d& reel,
                                                std::span<const Eigen::Vector3d> path,
                                                const PublishedOptions& options = {});

}  // namespace tautline::planning
