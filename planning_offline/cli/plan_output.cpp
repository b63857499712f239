#include "planning_offline/cli/plan_output.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/toml/config_file.h"
#include "planning_offline/cli/contact_output.h"
#include "planning_offline/cli/json_values.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

double element(const StateRisk& state, RiskElement e) {
  return state.elements[static_cast<std::size_t>(e)];
}

/// statesJson(), and per state what the tether does on the way to it.
json plannedStatesJson(const PlanResult& result, const PlanSpace& space) {
  json states = statesJson(result.report, space.problem.risk->enabled());
  const VoxelMap& map = *space.risk_space.space.map;
  if (!map.reel) return states;
  const ContactPlan contacts = contactsOf(result.report, map);
  for (std::size_t i = 0; i < contacts.states.size(); ++i)
    states[i].update(tetherJson(contacts.states[i]));
  return states;
}

}  // namespace

std::string riskTableText(const RiskReport& report, const std::vector<RiskElement>& elements) {
  std::string out = fmt::format("{:>5} {:>8} {:>8} {:>8}", "state", "x [m]", "y [m]", "z [m]");
  std::vector<std::size_t> widths;
  for (const RiskElement e : elements) {
    const std::string name = nameOf(e, kRiskElementNames);
    widths.push_back(std::max<std::size_t>(name.size(), 7));
    out += fmt::format("  {:>{}}", name, widths.back());
  }
  out += fmt::format("  {:>10}  {:>6}  {:>8}\n", "state risk", "tether", "contacts");
  for (std::size_t i = 0; i < report.states.size(); ++i) {
    const StateRisk& s = report.states[i];
    out += fmt::format("{:>5} {:>8.2f} {:>8.2f} {:>8.2f}", i, s.position.x(), s.position.y(),
                       s.position.z());
    for (std::size_t k = 0; k < elements.size(); ++k)
      out += fmt::format("  {:>{}.4f}", element(s, elements[k]), widths[k]);
    out +=
        fmt::format("  {:>10.4f}  {:>6.2f}  {:>8}\n", s.risk, s.tether_length, s.contacts.size());
  }
  return out;
}

std::string riskTableCsv(const RiskReport& report, const std::vector<RiskElement>& elements) {
  std::string out = "state,x_m,y_m,z_m";
  for (const RiskElement e : elements) out += fmt::format(",{}", nameOf(e, kRiskElementNames));
  out += ",state_risk,tether_length_m,contacts\n";
  for (std::size_t i = 0; i < report.states.size(); ++i) {
    const StateRisk& s = report.states[i];
    out += fmt::format("{},{},{},{}", i, s.position.x(), s.position.y(), s.position.z());
    for (const RiskElement e : elements) out += fmt::format(",{}", element(s, e));
    out += fmt::format(",{},{},{}\n", s.risk, s.tether_length, s.contacts.size());
  }
  return out;
}

json statesJson(const RiskReport& report, const std::vector<RiskElement>& elements) {
  json out = json::array();
  for (const StateRisk& s : report.states) {
    json row = {
        {"position_m", toJson(s.position)}, {"risk", s.risk}, {"tether_length_m", s.tether_length}};
    for (const RiskElement e : elements)
      row["elements"][nameOf(e, kRiskElementNames)] = element(s, e);
    row["contacts_m"] = json::array();
    for (const Eigen::Vector3d& contact : s.contacts) row["contacts_m"].push_back(toJson(contact));
    out.push_back(std::move(row));
  }
  return out;
}

ContactPlan contactsOf(const RiskReport& report, const VoxelMap& map,
                       const ContactOptions& options) {
  std::vector<Eigen::Vector3d> path;
  for (const StateRisk& state : report.states) path.push_back(state.position);
  return planContacts(map, *map.reel, path, options);
}

double wayLength(const RiskReport& report) {
  double length = 0.0;
  for (std::size_t i = 1; i < report.states.size(); ++i) {
    length += (report.states[i].position - report.states[i - 1].position).norm();
  }
  return length;
}

std::string summaryText(const std::string& planner, const PlanResult& result) {
  std::string out = fmt::format("{}: {}", planner, nameOf(result.status, kPlanStatusNames));
  if (result) {
    out += fmt::format(", risk {:.4f}, {} states, {:.2f} m", result.report.risk, result.path.size(),
                       wayLength(result.report));
    if (result.reward > 0.0)
      out += fmt::format(", reward {:.4g}, utility {:.4g}", result.reward, result.utility);
    if (!result.simple) out += ", visits a cell twice";
  }
  out += fmt::format(", {:.0f} ms", 1e3 * result.seconds);
  if (!result.text.empty()) out += fmt::format(": {}", result.text);
  return out;
}

json resultJson(const std::string& planner, const PlanResult& result, const PlanSpace& space) {
  json out = {{"planner", planner},
              {"status", nameOf(result.status, kPlanStatusNames)},
              {"text", result.text},
              {"simple", result.simple},
              {"expanded", result.expanded},
              {"time_ms", 1e3 * result.seconds},
              {"map", space.risk_space.space.map->name},
              {"frame", "M"},
              {"resolution_m", space.risk_space.space.map->resolution},
              {"connectivity", nameOf(space.problem.lattice->connectivity(), kConnectivityNames)},
              {"free_cells", space.problem.lattice->freeCount()},
              {"settings",
               {{"seed", space.options.seed},
                {"objective", nameOf(space.options.objective, kObjectiveNames)},
                {"risk_cap", space.options.risk_cap},
                {"discount", space.options.discount},
                {"lookback", space.options.lookback},
                {"time_limit_s", space.options.time_limit},
                {"label_limit", space.options.label_limit},
                {"clearance_m", space.clearance},
                {"params", dumpConfig(space.problem.risk->params())}}},
              {"risk", nullptr},
              {"reward", nullptr},
              {"utility", nullptr},
              {"path", json::array()},
              {"states", json::array()}};
  if (result) {
    out["risk"] = result.report.risk;
    out["reward"] = result.reward;
    out["utility"] = numberOrNull(result.utility);
    out["length_m"] = wayLength(result.report);
    for (const StateRisk& s : result.report.states) out["path"].push_back(toJson(s.position));
    out["states"] = plannedStatesJson(result, space);
  }
  if (result.risk_lower_bound)
    out["bound"] = {{"risk_at_least", numberOrNull(*result.risk_lower_bound)}};
  if (result.utility_upper_bound)
    out["bound"]["utility_at_most"] = numberOrNull(*result.utility_upper_bound);
  for (const FrontPoint& point : result.front) {
    json path = json::array();
    for (const CellIndex cell : point.path)
      path.push_back(toJson(space.risk_space.space.map->centre(cell)));
    out["front"].push_back(
        {{"risk", point.risk}, {"reward", point.reward}, {"path", std::move(path)}});
  }
  return out;
}

}  // namespace tautline::planning
