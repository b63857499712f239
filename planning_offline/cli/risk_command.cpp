/// @file
/// `tautline-plan risk`: the risk of a table of elements, or of a path on a map.

#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/mission/mission_file.h"
#include "common/plot/figure.h"
#include "common/toml/toml_file.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/cli/commands.h"
#include "planning_offline/cli/plan_output.h"
#include "planning_offline/cli/terminal_progress.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/field/line_of_sight.h"
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

/// Points of a mission file (shifted from W to M), or of a text file with x y z a line (spaces or
/// commas, # comments).
std::vector<Eigen::Vector3d> readPath(const std::string& file) {
  std::vector<Eigen::Vector3d> points;
  if (file.ends_with(".toml")) {
    const Mission mission = readMission(file);
    // A waypoint where the last one is only switches the contact: no state of its own.
    for (int i = 0; i < mission.plan->waypoint_count; ++i) {
      const Eigen::Vector3d p =
          mission.plan->waypoints[static_cast<std::size_t>(i)].p_WD + mission.reel_position;
      if (points.empty() || p != points.back()) points.push_back(p);
    }
    return points;
  }
  std::istringstream text(readTextFile(file));
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    line = line.substr(0, line.find('#'));
    for (char& c : line) c = c == ',' || c == '\r' ? ' ' : c;
    std::istringstream fields(line);
    Eigen::Vector3d p;
    fields >> std::ws;
    if (fields.eof()) continue;
    if (!(fields >> p.x() >> p.y() >> p.z()) || !p.allFinite() || !(fields >> std::ws).eof()) {
      throw InputError({.file = file,
                        .line = number,
                        .problem = fmt::format("is '{}'", line),
                        .allowed = "x y z in metres"});
    }
    points.push_back(p);
  }
  if (points.empty())
    throw InputError(
        {.file = file, .problem = "has no point", .allowed = "x y z in metres, one point a line"});
  return points;
}

/// Throws InputError for the first point or way between two that is not in free space.
void needFreeWay(const std::vector<Eigen::Vector3d>& path, const MapSpace& space,
                 const std::string& file) {
  const VoxelMap& map = *space.map;
  std::vector<std::uint8_t> blocked;
  for (const std::uint8_t free : space.lattice->freeCells()) blocked.push_back(free != 0 ? 0 : 1);
  const auto cells = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return (p - map.origin) / map.resolution;
  };
  for (std::size_t i = 0; i < path.size(); ++i) {
    const CellIndex cell = map.indexAt(path[i]);
    if (cell == kNoCell || !space.lattice->free(cell)) {
      throw InputError({.file = file,
                        .key = fmt::format("point {}", i),
                        .problem = fmt::format(
                            "{} is {} the map {}", pointText(path[i]),
                            cell == kNoCell ? "outside" : "not in the free space of", map.name)});
    }
    if (i > 0 && !lineOfSight(map.shape, blocked, cells(path[i - 1]), cells(path[i]))) {
      throw InputError(
          {.file = file,
           .key = fmt::format("points {} to {}", i - 1, i),
           .problem = fmt::format("the way from {} to {} leaves the free space of the map {}",
                                  pointText(path[i - 1]), pointText(path[i]), map.name)});
    }
  }
}

ExitCode runPath(const Arguments& arguments) {
  TerminalProgress terminal;
  const RiskSpace space = loadRiskSpace(arguments.risk, terminal.progress());
  const VoxelMap& map = *space.space.map;
  const std::vector<Eigen::Vector3d> path = readPath(arguments.path);
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
                   "Mission, or text with x y z [m] a line, frame of the map")
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
