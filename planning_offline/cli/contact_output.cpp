#include "planning_offline/cli/contact_output.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "planning_offline/cli/json_values.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

std::string rounded(const Eigen::Vector3d& p) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f})", p.x(), p.y(), p.z());
}

template <class Test>
int count(const ContactPlan& plan, Test test) {
  return static_cast<int>(std::count_if(plan.states.begin(), plan.states.end(), test));
}

/// Between which lengths friction decides. The frictionless one is the longer one where the string
/// without friction went another way round an obstacle.
std::optional<std::pair<double, double>> intervalOf(const TetherState& state) {
  if (!state.frictionless_length) return std::nullopt;
  return std::minmax({*state.frictionless_length, state.length});
}

std::string lengthText(const TetherState& state) {
  constexpr double kSame = 5e-4;  // [m]: printed alike
  const auto interval = intervalOf(state);
  if (!interval || interval->second - interval->first < kSame)
    return fmt::format("{:.3f}", state.length);
  return fmt::format("{:.3f} … {:.3f}", interval->first, interval->second);
}

/// What went wrong at a waypoint (as published only).
std::string flagsText(const TetherState& state) {
  std::string text;
  if (state.relaxation_refused) text += "  relaxation refused";
  if (state.pierces) text += "  tether through an obstacle";
  return text;
}

std::string eventText(const ContactEvent& event, const TetherState& state) {
  std::string text =
      fmt::format("{} {}", nameOf(event.kind, kContactChangeNames), rounded(event.position));
  if (event.vehicle != state.position)
    text += fmt::format(" on the way, at {}", rounded(event.vehicle));
  return text;
}

}  // namespace

json publishedTetherJson(const TetherState& state) {
  json out = tetherJson(state);
  out["relaxation_refused"] = state.relaxation_refused;
  out["tether_through_obstacle"] = state.pierces;
  return out;
}

json tetherJson(const TetherState& state) {
  json out = {{"tether_length_m", state.length},
              {"tether_length_interval_m", nullptr},
              {"contacts_m", json::array()},
              {"events", json::array()}};
  if (const auto interval = intervalOf(state))
    out["tether_length_interval_m"] = {interval->first, interval->second};
  for (const Eigen::Vector3d& contact : state.contacts)
    out["contacts_m"].push_back(toJson(contact));
  for (const ContactEvent& event : state.events) {
    out["events"].push_back({{"kind", nameOf(event.kind, kContactChangeNames)},
                             {"position_m", toJson(event.position)},
                             {"vehicle_m", toJson(event.vehicle)},
                             {"tether_length_before_m", event.length_before},
                             {"tether_length_m", event.length}});
  }
  return out;
}

std::string contactsText(const ContactPlan& plan) {
  std::string out = fmt::format("{:>8} {:>8} {:>8} {:>8}  {:>17}  {:>8}  {}\n", "waypoint", "x [m]",
                                "y [m]", "z [m]", "tether [m]", "contacts", "events");
  for (std::size_t i = 0; i < plan.states.size(); ++i) {
    const TetherState& s = plan.states[i];
    out += fmt::format("{:>8} {:>8.3f} {:>8.3f} {:>8.3f}  {:>17}  {:>8}", i, s.position.x(),
                       s.position.y(), s.position.z(), lengthText(s), s.contacts.size());
    const char* before = "  ";
    for (const ContactEvent& event : s.events) {
      out += before + eventText(event, s);
      before = "; ";
    }
    out += flagsText(s) + "\n";
  }
  return out;
}

std::string contactsCsv(const ContactPlan& plan) {
  std::string out =
      "waypoint,x_m,y_m,z_m,tether_length_m,frictionless_length_m,contacts,contacts_m,events\n";
  for (std::size_t i = 0; i < plan.states.size(); ++i) {
    const TetherState& s = plan.states[i];
    const auto point = [](const Eigen::Vector3d& p) {
      return fmt::format("{} {} {}", p.x(), p.y(), p.z());
    };
    std::string contacts;
    for (const Eigen::Vector3d& contact : s.contacts)
      contacts += (contacts.empty() ? "" : ";") + point(contact);
    std::string events;
    for (const ContactEvent& event : s.events) {
      events += fmt::format("{}{} {} at {}", events.empty() ? "" : ";",
                            nameOf(event.kind, kContactChangeNames), point(event.position),
                            point(event.vehicle));
    }
    out += fmt::format("{},{},{},{},{},{},{},{},{}\n", i, s.position.x(), s.position.y(),
                       s.position.z(), s.length,
                       s.frictionless_length ? fmt::format("{}", *s.frictionless_length) : "",
                       s.contacts.size(), contacts, events);
  }
  return out;
}

std::string comparisonText(const ContactComparison& comparison) {
  const auto cell = [](const TetherState& state) {
    std::string text = fmt::format("{:>8.3f}  {}", state.length, state.contacts.size());
    for (const ContactEvent& event : state.events)
      text +=
          fmt::format("  {} {}", nameOf(event.kind, kContactChangeNames), rounded(event.position));
    return text + flagsText(state);
  };
  std::string out =
      fmt::format("{:>8}  {:<60}  {}\n{:>8}  {:<60}  {}\n", "", "as published", "taut string",
                  "waypoint", "length [m], contacts, changes", "length [m], contacts, changes");
  bool refused = false;  // a run of refusals is one row
  for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
    const auto& [published, exact] = comparison.rows[i];
    const bool changes = !published.events.empty() || !exact.events.empty() || published.pierces ||
                         (published.relaxation_refused && !refused);
    refused = published.relaxation_refused;
    if (changes || i + 1 == comparison.rows.size())
      out += fmt::format("{:>8}  {:<60}  {}\n", i, cell(published), cell(exact));
  }
  return out +
         fmt::format(
             "{} waypoints, largest difference of length {:.3f} m, {} relaxations refused, {} "
             "waypoints with the published tether through an obstacle\n",
             comparison.rows.size(), largestDifference(comparison), countRefused(comparison),
             countPierced(comparison));
}

json comparisonJson(const ContactComparison& comparison) {
  json out = {{"relaxations_refused", countRefused(comparison)},
              {"tether_through_obstacles", countPierced(comparison)},
              {"largest_difference_m", largestDifference(comparison)},
              {"unresolved_moves", comparison.unresolved_moves},
              {"rows", json::array()}};
  for (const auto& [published, exact] : comparison.rows) {
    json row = {{"position_m", toJson(exact.position)},
                {"published", publishedTetherJson(published)},
                {"exact", tetherJson(exact)}};
    out["rows"].push_back(std::move(row));
  }
  return out;
}

int refusedRelaxations(const ContactPlan& plan) {
  return count(plan, [](const TetherState& state) { return state.relaxation_refused; });
}

int piercingStates(const ContactPlan& plan) {
  return count(plan, [](const TetherState& state) { return state.pierces; });
}

std::string contactsSummary(const ContactPlan& plan) {
  std::string out = fmt::format(
      "{}: {} waypoints, longest tether {:.3f} m, contacts: {} formed, {} released",
      nameOf(plan.algorithm, kContactAlgorithmNames), plan.states.size(), longestTether(plan),
      countEvents(plan, ContactChange::kPush), countEvents(plan, ContactChange::kPop));
  if (plan.algorithm == ContactAlgorithm::kAsPublished) {
    out += fmt::format(", {} relaxations refused, {} waypoints with the tether through an obstacle",
                       refusedRelaxations(plan), piercingStates(plan));
  }
  if (plan.unresolved_moves > 0)
    out += fmt::format(", {} legs unresolved (docs/taut_string.md)", plan.unresolved_moves);
  return out;
}

}  // namespace tautline::planning
