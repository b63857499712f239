#include "planning_offline/cli/plan_output.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/error.h"
#include "common/toml/config_file.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

json toJson(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
json numberOrNull(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

double element(const StateRisk& state, RiskElement e) {
  return state.elements[static_cast<std::size_t>(e)];
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
    out["states"] = statesJson(result.report, space.problem.risk->enabled());
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

void needReel(const VoxelMap& map) {
  if (map.reel) return;
  throw InputError({.key = "--output",
                    .problem = "a mission needs the place of the reel, and the map has none",
                    .remedy = "--reel x,y,z"},
                   ExitCode::kUsage);
}

Mission missionOf(const PlanResult& result, const VoxelMap& map, const std::string& description,
                  const std::filesystem::path& file) {
  needReel(map);
  Mission mission;
  mission.name = file.stem().stem().string();
  mission.description = description;
  mission.reel_position = *map.reel;
  mission.map =
      std::filesystem::relative(map.file, std::filesystem::absolute(file).parent_path()).string();
  mission.map_hash = hashText(map.hash);
  MissionPlan& plan = *mission.plan;
  const auto tooMany = [&](const char* what, int most) {
    return InputError({.file = file.string(),
                       .problem = fmt::format("the plan has more {} than a mission holds", what),
                       .allowed = fmt::format("{}", most),
                       .remedy = "plan with a larger --resolution"});
  };
  // A stack that grows by several contacts in one step becomes as many waypoints at the same place:
  // a mission forms one contact a waypoint.
  std::vector<int> stack;
  for (const StateRisk& state : result.report.states) {
    std::size_t kept = 0;
    while (kept < stack.size() && kept < state.contacts.size() &&
           anchorPosition(plan, stack[kept]) == state.contacts[kept] - *map.reel) {
      ++kept;
    }
    stack.resize(kept);
    do {
      if (stack.size() < state.contacts.size()) {
        if (plan.contact_count == kMaxContacts) throw tooMany("contacts", kMaxContacts);
        MissionContact& contact = plan.contacts[static_cast<std::size_t>(plan.contact_count++)];
        contact = {plan.contact_count, state.contacts[stack.size()] - *map.reel};
        stack.push_back(contact.id);
      }
      if (plan.waypoint_count == kMaxWaypoints) throw tooMany("waypoints", kMaxWaypoints);
      Waypoint& waypoint = plan.waypoints[static_cast<std::size_t>(plan.waypoint_count++)];
      waypoint.p_WD = state.position - *map.reel;
      waypoint.contact = stack.empty() ? kReelContact : stack.back();
      waypoint.risk = state.risk;
    } while (stack.size() < state.contacts.size());
  }
  return mission;
}

}  // namespace tautline::planning
