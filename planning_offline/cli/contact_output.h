#pragma once

/// @file
/// Paths with their tether as text, JSON and CSV. Not real-time safe: offline only.

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "planning_offline/tether/compare_contacts.h"
#include "planning_offline/tether/contact_plan.h"

namespace tautline::planning {

/// `tether_length_m`; `tether_length_interval_m`, the lengths without friction and of the pinned
/// string, the lesser first, null where the former is not known; `contacts_m` from the reel to the
/// vehicle; `events`.
[[nodiscard]] nlohmann::json tetherJson(const TetherState& state);

/// The same of the published planner's tether, with `relaxation_refused` and
/// `tether_through_obstacle`.
[[nodiscard]] nlohmann::json publishedTetherJson(const TetherState& state);

/// One row a waypoint, its events below it.
[[nodiscard]] std::string contactsText(const ContactPlan& plan);

/// One row a waypoint.
[[nodiscard]] std::string contactsCsv(const ContactPlan& plan);

/// One line: waypoints, longest tether, contacts formed and released, and what went wrong.
[[nodiscard]] std::string contactsSummary(const ContactPlan& plan);

/// The dissertation's contacts beside the taut string's: one row for each waypoint where either
/// changes, and the counts and lengths below.
[[nodiscard]] std::string comparisonText(const ContactComparison& comparison);
/// `rows` with `published` and `exact` (tetherJson()) for every waypoint, and the counts.
[[nodiscard]] nlohmann::json comparisonJson(const ContactComparison& comparison);

/// Waypoints at which a contact stayed that is not needed (as published).
[[nodiscard]] int refusedRelaxations(const ContactPlan& plan);
/// Waypoints at which the tether leads through an obstacle (as published).
[[nodiscard]] int piercingStates(const ContactPlan& plan);

}  // namespace tautline::planning
