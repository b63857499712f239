/// @file
/// `tautline-plan scen`: shortest paths against the published optima of the MovingAI benchmarks.

#include <memory>
#include <string>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "planning_offline/cli/commands.h"
#include "planning_offline/cli/terminal_progress.h"
#include "planning_offline/map/load_map.h"
#include "planning_offline/scenario/scenario.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

struct Arguments {
  std::string map;
  std::string scenarios;
  bool json{false};
  bool all{false};
};

json cellJson(const Eigen::Vector3i& c) { return {c.x(), c.y(), c.z()}; }

std::string rowText(const ScenarioResult& row) {
  const Scenario& s = row.scenario;
  return fmt::format("{:>6}  ({}, {}, {}) to ({}, {}, {})  published {:.8f}  found {}\n", s.line,
                     s.start.x(), s.start.y(), s.start.z(), s.goal.x(), s.goal.y(), s.goal.z(),
                     s.length, row.found ? fmt::format("{:.8f}", *row.found) : "no path");
}

ExitCode run(const Arguments& arguments) {
  TerminalProgress terminal;
  const VoxelMap map = loadMap(arguments.map, {});
  const ScenarioFile scenarios = readScenarios(arguments.scenarios);
  const ScenarioReport report = checkScenarios(map, scenarios, terminal.progress());
  terminal.clear();
  if (arguments.json) {
    json out = {{"map", map.name},
                {"scenarios", scenarios.rows.size()},
                {"checked", report.rows.size()},
                {"mismatches", report.mismatches},
                {"cancelled", report.cancelled},
                {"rows", json::array()}};
    for (const ScenarioResult& row : report.rows) {
      out["rows"].push_back({{"line", row.scenario.line},
                             {"start", cellJson(row.scenario.start)},
                             {"goal", cellJson(row.scenario.goal)},
                             {"published", row.scenario.length},
                             {"found", row.found ? json(*row.found) : json(nullptr)},
                             {"equal", row.equal}});
    }
    fmt::print("{}\n", out.dump(2));
  } else {
    for (const ScenarioResult& row : report.rows) {
      if (arguments.all || !row.equal) fmt::print("{}", rowText(row));
    }
    fmt::print("{} of {} scenarios checked, {} mismatches{}\n", report.rows.size(),
               scenarios.rows.size(), report.mismatches, report.cancelled ? ", stopped" : "");
  }
  return report ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addScenCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb = app.add_subcommand(
      "scen", "Check shortest paths against MovingAI scenarios. Exit code 1 on a mismatch");
  const auto arguments = std::make_shared<Arguments>();
  verb->add_option("map", arguments->map, "MovingAI .map or .3dmap")->required()->type_name("MAP");
  verb->add_option("scenarios", arguments->scenarios, "MovingAI .scen or .3dscen of that map")
      ->required()
      ->type_name("SCEN");
  verb->add_flag("--all", arguments->all, "Print every row, not only mismatches");
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  verb->footer("Example: tautline-plan scen Simple.3dmap Simple.3dscen");
  verb->callback([arguments, &result] { result = run(*arguments); });
}

}  // namespace tautline::planning
