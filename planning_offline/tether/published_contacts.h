#pragma once

/// @file
/// The dissertation's own tether contact planner (chapter 5, Algorithm 3, "Contact Point(s)
/// Planning and Relaxation"), as printed, faults included: a baseline to compare the taut string
/// with (taut_string.h), not a model to fly by. docs/contact_comparison.md has what it gets wrong,
/// and how the points that the text leaves open were read off the authors' own flown paths.
///
/// For every waypoint one look: if the line from the last contact but one to the waypoint is free
/// and no obstacle is confined in the triangle of waypoint and last two contacts, the last contact
/// is relaxed; else, if the line from the last contact to the waypoint is blocked, one contact is
/// added. At most one of both a waypoint, and what the tether swept between two waypoints is not
/// looked at.
///
/// Points in M [m]. Only occupied cells touch the tether; a planar map takes all points into the
/// middle of its plane. Not real-time safe: offline only.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/obstacle_confined.h"

namespace tautline::planning {

/// Where a new contact is put. The text does not say.
enum class ContactPlacement : std::uint8_t {
  kNearestEdge,  ///< On the convex edge nearest to the place where the line enters the obstacle, at
                 ///< that place's height along the edge: what the authors' flown paths show.
  kCorner,       ///< On the convex edge of the cut cells that makes the shortest way from anchor to
                 ///< waypoint; of those that both see, if there are any.
  kEntry,        ///< Where the line enters the obstacle: the first sample inside.
};

/// From which waypoint on a change of contacts holds.
enum class Attachment : std::uint8_t {
  kThisWaypoint,       ///< The one that caused it: what the authors' flown paths show.
  kFollowingWaypoint,  ///< The one after it: the letter of the text.
};

struct PublishedOptions {
  ContactPlacement placement{ContactPlacement::kNearestEdge};
  Confinement confinement{Confinement::kTouching};
  Attachment attachment{Attachment::kThisWaypoint};
  /// From one point to the next of the lines that CheckCollision() draws, counted from the contact
  /// [cells], 0.001 to 1. What is thinner than it can be missed.
  double sample_step{0.1};
  /// How far from both faces beside its edge a contact is put [cells], 0 to 0.5. Not for kEntry. If
  /// another cell touches the edge from across, the contact is inside that one.
  double standoff{0.1};
};

/// The plan for one waypoint.
struct PublishedState {
  std::vector<Eigen::Vector3d> contacts;  ///< From the reel to the vehicle.
  bool relaxation_refused{false};         ///< The line was free, but an obstacle was confined.
  bool pierces{false};                    ///< This tether goes through the inside of an obstacle.
};

/// One state a waypoint. The path may begin anywhere; the first look is at its first waypoint.
/// Throws InputError: the reel is inside an obstacle (checkedReel()), reel or a waypoint is not
/// finite or farther than kSightFarthest cells from the map's origin, an option is out of range.
[[nodiscard]] std::vector<PublishedState> publishedContacts(const VoxelMap& map,
                                                            const Eigen::Vector3d& reel,
                                                            std::span<const Eigen::Vector3d> path,
                                                            const PublishedOptions& options = {});

}  // namespace tautline::planning
