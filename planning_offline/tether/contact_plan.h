#pragma once

/// @file
/// A waypoint path with its tether: contacts, length, and where on the way contacts form and come
/// off. All points in M [m]. Not real-time safe: offline only.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/fields.h"
#include "planning_offline/map/voxel_map.h"
#include "planning_offline/tether/published_contacts.h"

namespace tautline::planning {

enum class ContactAlgorithm : std::uint8_t {
  kExact,        ///< The taut string (docs/taut_string.md).
  kAsPublished,  ///< The dissertation's Algorithm 3 (docs/contact_comparison.md).
};
inline constexpr std::array<EnumName<ContactAlgorithm>, 2> kContactAlgorithmNames{
    {{ContactAlgorithm::kExact, "exact"}, {ContactAlgorithm::kAsPublished, "as-published"}}};

enum class ContactChange : std::uint8_t { kPush, kPop };
inline constexpr std::array<EnumName<ContactChange>, 2> kContactChangeNames{
    {{ContactChange::kPush, "push"}, {ContactChange::kPop, "pop"}}};

/// One contact more or less on top of the stack.
struct ContactEvent {
  ContactChange kind{ContactChange::kPush};
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};  ///< Of the contact.
  Eigen::Vector3d vehicle{Eigen::Vector3d::Zero()};   ///< Where the vehicle is when it happens.
  /// Taut tether then, before and after the event [m]. A pinned contact that comes off in space can
  /// shorten it at once: friction held it.
  double length_before{0.0};
  double length{0.0};

  /// What the reel must have given for the event to come about [m].
  [[nodiscard]] double longest() const noexcept { return std::max(length_before, length); }
};

/// The tether when the vehicle is at a waypoint.
struct TetherState {
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};
  std::vector<Eigen::Vector3d> contacts{};  ///< From the reel to the vehicle.
  double length{0.0};                       ///< Taut, along the contacts.
  /// What the length would be if contacts slid without friction (sliding_string.h): the true one is
  /// between the two. Absent where it is not known: as published, and after a way through an
  /// obstacle.
  std::optional<double> frictionless_length{};
  /// On the way from the waypoint before, in order; at the first waypoint all its contacts. They
  /// turn the contacts of the state before into these, up to the tolerance of planContacts().
  std::vector<ContactEvent> events{};
  bool relaxation_refused{false};  ///< As published only: a contact stayed that is not needed.
  bool pierces{false};             ///< As published only: the tether leads through an obstacle.
};

struct ContactPlan {
  ContactAlgorithm algorithm{ContactAlgorithm::kExact};
  std::vector<TetherState> states{};  ///< One a waypoint.
  std::int64_t unresolved_moves{0};   ///< TautString::unresolvedMoves() of the legs flown.
};

struct ContactOptions {
  ContactAlgorithm algorithm{ContactAlgorithm::kExact};
  PublishedOptions published{};  ///< For kAsPublished.
  bool frictionless{true};       ///< Exact: find TetherState::frictionless_length too.
};

/// The path is flown in straight legs, after a straight line from the reel to its first waypoint;
/// it is not judged whether the vehicle may fly there. Stacks at the waypoints are those of one
/// move a leg (TautString::move()). Exact: where on a leg a contact forms or comes off is found by
/// moves to parts of it, half a cell apart, then halved down to 1e-6 of a cell; an event nearer
/// than 2e-3 of a cell to an end of its leg happens at that end, and contacts nearer to each other
/// than 1e-3 of a cell are the same. As published: at the waypoint. Without waypoints: no states.
/// Throws InputError if the reel is inside an obstacle; as published also like publishedContacts().
[[nodiscard]] ContactPlan planContacts(const VoxelMap& map, const Eigen::Vector3d& reel,
                                       std::span<const Eigen::Vector3d> path,
                                       const ContactOptions& options = {});

/// Longest taut tether on the way [m]: between events, each counted with the lengths before and
/// after it, the length is greatest at an end.
[[nodiscard]] double longestTether(const ContactPlan& plan);

[[nodiscard]] int countEvents(const ContactPlan& plan, ContactChange kind);

}  // namespace tautline::planning
