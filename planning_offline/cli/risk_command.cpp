/// @file
/// `tautline-plan risk`: the risk of a table of elements, or of a path on a map.

#include <memory>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/plot/figure.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/cli/commands.h"
#include "planning_offline/cli/path_file.h"
#include "planning_offline/cli/plan_output.h"
#include "planning_offline/cli/terminal_progress.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/picture/plan_picture.h"
#include "planning_offline/risk/table_file.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

struct Arguments {
  RiskArguments risk;
  std::string table;
  std::string name;
  std::string path;
  bool json{false};
  std::string csv;
  std::string svg;
};

ExitCode runTable(const Arguments& arguments) {
  const TableRisk risk = riskOfTable(readRiskTable(arguments.table, arguments.name));
  if (arguments.json) {
    fmt::print("{}\n", json{{"risk", risk.risk},
                            {"state_risk", risk.state_risk},
                            {"cost", std::isfinite(risk.cost) ? json(risk.cost) : json(nullptr)}}
                           .dump(2));
    return ExitCode::kOk;
  }
  fmt::print("state  state risk\n");
  for (std::size_t i = 0; i < risk.state_risk.size(); ++i)
    fmt::print("{:>5}  {:>10.6f}\n", i, risk.state_risk[i]);
  fmt::print("risk of the path: {:.6f}\n", risk.risk);
  return ExitCode::kOk;
}

ExitCode runPath(const Arguments& arguments) {
  TerminalProgress terminal;
  const RiskSpace space = loadRiskSpace(arguments.risk, terminal.progress());
  const VoxelMap& map = *space.space.map;
  const std::vector<Eigen::Vector3d> path =
      readPath(arguments.path, {.reel = map.reel, .legacy = {}, .states_only = true}).points;
  needFreeWay(path, space.space, arguments.path);
  const RiskReport report = space.risk->evaluate(path);
  const std::vector<RiskElement> elements = space.risk->enabled();
  terminal.clear();
  if (!arguments.csv.empty()) writeFileAtomically(arguments.csv, riskTableCsv(report, elements));
  if (!arguments.svg.empty()) {
    plot::writeSvg(planFigure(fmt::format("{}: risk {:.3f}", map.name, report.risk), map,
                              {{"path", &report}}, map.rewards),
                   arguments.svg);
  }
  if (arguments.json) {
    std::vector<double> state_risk;
    for (const StateRisk& state : report.states) state_risk.push_back(state.risk);
    fmt::print("{}\n", json{{"risk", report.risk},
                            {"state_risk", state_risk},
                            {"states", statesJson(report, elements)}}
                           .dump(2));
  } else {
    fmt::print("{}risk of the path: {:.6f}\n", riskTableText(report, elements), report.risk);
  }
  return ExitCode::kOk;
}

ExitCode run(const Arguments& arguments) {
  if (!arguments.table.empty()) return runTable(arguments);
  if (arguments.path.empty()) {
    throw InputError({.key = "risk",
                      .problem = "needs something to judge",
                      .allowed = "--table FILE, or --map FILE with --path FILE"},
                     ExitCode::kUsage);
  }
  return runPath(arguments);
}

}  // namespace

void addRiskCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb = app.add_subcommand(
      "risk", "Risk of a table of elements, or of a path on a map, state by state");
  const auto arguments = std::make_shared<Arguments>();
  arguments->risk.addTo(*verb);
  CLI::Option* map = verb->get_option("--map");
  map->required(false);
  CLI::Option* table = verb->add_option("--table", arguments->table,
                                        "TOML with elements = [[r, …], …], one row a state")
                           ->type_name("FILE");
  verb->add_option("--name", arguments->name,
                   "Table of that file, e.g. red_path; default: its top level")
      ->needs(table);
  verb->add_option("--path", arguments->path,
                   "Mission, text with x y z [m] a line in the frame of the map, or legacy path")
      ->type_name("FILE")
      ->needs(map)
      ->excludes(table);
  table->excludes(map);
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  verb->add_option("--csv", arguments->csv, "Write the table of states and elements (with --path)")
      ->type_name("FILE")
      ->excludes(table);
  verb->add_option("--svg", arguments->svg, "Draw the path over the map (with --path)")
      ->type_name("FILE")
      ->excludes(table);
  verb->footer("Example: tautline-plan risk --table config/risk/tables/red_path.toml --json");
  verb->callback([arguments, &result] { result = run(*arguments); });
}

}  // namespace tautline::planning
