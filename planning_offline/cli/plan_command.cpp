/// @file
/// `tautline-plan plan` and `why`.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/plot/figure.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/cli/commands.h"
#include "planning_offline/cli/explain.h"
#include "planning_offline/cli/mission_output.h"
#include "planning_offline/cli/path_file.h"
#include "planning_offline/cli/plan_output.h"
#include "planning_offline/cli/terminal_progress.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/picture/plan_picture.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

struct Arguments {
  PlanArguments plan;
  std::string planner{"directional"};
  bool json{false};
  bool why{false};
  std::string csv;
  std::string svg;
  std::string output;
};

void addShared(CLI::App& verb, Arguments& arguments) {
  arguments.plan.addTo(verb);
  std::string names;
  for (const PlannerInfo& info : planners())
    names += fmt::format("{}{}", names.empty() ? "" : "|", info.name);
  verb.add_option("--planner", arguments.planner, "What plans: docs/planning.md")
      ->type_name(names)
      ->capture_default_str();
  verb.add_flag("--json", arguments.json, "Machine-readable output");
}

json explanationJson(const Explanation& e, const PlanSpace& space, const std::string& planner) {
  json out = {{"worst_state", e.worst_state}, {"shares", json::array()}};
  for (const auto& share : e.shares) {
    out["shares"].push_back({{"element", nameOf(share.element, kRiskElementNames)},
                             {"share", share.share},
                             {"risk_alone", share.risk}});
  }
  if (e.avoided_state) out["avoided_state"] = *e.avoided_state;
  out["runner_up"] = e.runner_up ? resultJson(planner, *e.runner_up, space) : json(nullptr);
  return out;
}

/// Exit code of a result: a path, however it was cut, is an answer.
ExitCode codeOf(const PlanResult& result) { return result ? ExitCode::kOk : ExitCode::kFailed; }

std::vector<Waypoint> ordersOf(const RiskReport& report) {
  std::vector<Waypoint> orders(report.states.size());
  for (std::size_t i = 0; i < orders.size(); ++i) orders[i].risk = report.states[i].risk;
  return orders;
}

/// What a mission needs and a plan does not: a reel, and a start that a straight tether reaches.
void needFlyableStart(const PlanSpace& space) {
  const VoxelMap& map = *space.risk_space.space.map;
  needReel(map);
  needStraightStart(map, *map.reel, map.centre(space.problem.start), {});
}

void writeFiles(const Arguments& arguments, const PlanResult& result, const PlanSpace& space) {
  const VoxelMap& map = *space.risk_space.space.map;
  const std::string title =
      fmt::format("{}, {}: risk {:.3f}", map.name, arguments.planner, result.report.risk);
  std::optional<Mission> mission;  // made first: what cannot be a mission leaves no file behind
  if (!arguments.output.empty()) {
    mission =
        missionOf(contactsOf(result.report, map, {.frictionless = false}), ordersOf(result.report),
                  map, fmt::format("Planned by {}", title), arguments.output);
  }
  if (!arguments.csv.empty())
    writeFileAtomically(arguments.csv, riskTableCsv(result.report, space.problem.risk->enabled()));
  if (!arguments.svg.empty())
    plot::writeSvg(planFigure(title, map, {{"path", &result.report}}, space.rewards),
                   arguments.svg);
  if (mission) writeMission(*mission, arguments.output);
}

ExitCode runPlan(const Arguments& arguments) {
  TerminalProgress terminal;
  const PlanSpace space = loadPlanSpace(arguments.plan, terminal.progress());
  if (!arguments.output.empty()) needFlyableStart(space);
  const PlanResult result =
      solve(arguments.planner, space.problem, space.options, terminal.progress());
  std::optional<Explanation> explanation;
  if (arguments.why && result && !terminal.cancelled()) {
    explanation =
        explain(arguments.planner, space.problem, space.options, result, terminal.progress());
  }
  terminal.clear();
  if (result) writeFiles(arguments, result, space);
  if (arguments.json) {
    json out = resultJson(arguments.planner, result, space);
    if (explanation) out["why"] = explanationJson(*explanation, space, arguments.planner);
    fmt::print("{}\n", out.dump(2));
    return codeOf(result);
  }
  fmt::print("{}\n", summaryText(arguments.planner, result));
  if (!result) return codeOf(result);
  if (result.risk_lower_bound)
    fmt::print("no path has less risk than {:.6f}\n", *result.risk_lower_bound);
  if (result.utility_upper_bound)
    fmt::print("no path has more utility than {:.6g}\n", *result.utility_upper_bound);
  fmt::print("{}", riskTableText(result.report, space.problem.risk->enabled()));
  if (explanation) fmt::print("{}", explanationText(*explanation, result));
  for (const std::string* file : {&arguments.csv, &arguments.svg, &arguments.output}) {
    if (!file->empty()) fmt::print("written: {}\n", *file);
  }
  return codeOf(result);
}

ExitCode runWhy(const Arguments& arguments) {
  TerminalProgress terminal;
  const PlanSpace space = loadPlanSpace(arguments.plan, terminal.progress());
  const PlanResult result =
      solve(arguments.planner, space.problem, space.options, terminal.progress());
  if (!result) {
    terminal.clear();
    fmt::print("{}\n", summaryText(arguments.planner, result));
    return codeOf(result);
  }
  const Explanation explanation =
      explain(arguments.planner, space.problem, space.options, result, terminal.progress());
  terminal.clear();
  if (arguments.json) {
    json out = explanationJson(explanation, space, arguments.planner);
    out["plan"] = resultJson(arguments.planner, result, space);
    fmt::print("{}\n", out.dump(2));
  } else {
    fmt::print("{}\n{}", summaryText(arguments.planner, result),
               explanationText(explanation, result));
  }
  return codeOf(result);
}

}  // namespace

void addPlanCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb =
      app.add_subcommand("plan", "Plan a path and tell its risk. Exit code 1 if there is none");
  const auto arguments = std::make_shared<Arguments>();
  addShared(*verb, *arguments);
  verb->add_flag("--why", arguments->why, "Also tell what the risk is made of, and the runner-up");
  verb->add_option("--csv", arguments->csv, "Write the table of states and elements")
      ->type_name("FILE");
  verb->add_option("--svg", arguments->svg, "Draw the path over the map")->type_name("FILE");
  verb->add_option("-o,--output", arguments->output, "Write the mission")
      ->type_name("FILE.mission.toml");
  verb->footer(
      "Example: tautline-plan plan --map config/scenes/one_contact.scene.toml --resolution 0.2 "
      "--clearance 0.3 --start 1.5,0.9,2.1 --goal 3.3,1.3,3.5 --planner tether "
      "--svg plan.svg -o plan.mission.toml");
  verb->callback([arguments, &result] { result = runPlan(*arguments); });
}

void addWhyCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb = app.add_subcommand(
      "why", "Explain a plan: what dominates its risk, what the runner-up costs");
  const auto arguments = std::make_shared<Arguments>();
  addShared(*verb, *arguments);
  verb->footer(
      "Example: tautline-plan why --map config/scenes/one_contact.scene.toml --resolution 0.2 "
      "--clearance 0.3 --start 1.5,0.9,2.1 --goal 3.3,1.3,3.5");
  verb->callback([arguments, &result] { result = runWhy(*arguments); });
}

}  // namespace tautline::planning
