/// @file
/// `tautline-plan compare`: planners side by side on the same map.

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
#include "planning_offline/cli/plan_output.h"
#include "planning_offline/cli/terminal_progress.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/picture/plan_picture.h"

namespace tautline::planning {
namespace {

struct Arguments {
  PlanArguments plan;
  std::vector<std::string> planners;
  bool json{false};
  std::string csv;
  std::string svg;
};

/// Above so many free cells `exact` only counts paths until it is cut: it then runs only if it is
/// named.
constexpr std::size_t kExactCells = 40;

struct Row {
  std::string planner;
  PlanResult result;
};

double longestTether(const RiskReport& report) {
  double longest = 0.0;
  for (const StateRisk& state : report.states) longest = std::max(longest, state.tether_length);
  return longest;
}

std::size_t mostContacts(const RiskReport& report) {
  std::size_t most = 0;
  for (const StateRisk& state : report.states) most = std::max(most, state.contacts.size());
  return most;
}

std::string table(const std::vector<Row>& rows) {
  std::string out =
      fmt::format("{:<18} {:<11} {:>8} {:>8} {:>9} {:>7} {:>8} {:>8} {:>9} {:>10} {:>10}\n",
                  "planner", "status", "risk", "reward", "utility", "states", "way [m]", "contacts",
                  "tether[m]", "expanded", "time [ms]");
  for (const Row& row : rows) {
    const PlanResult& r = row.result;
    out += fmt::format("{:<18} {:<11} ", row.planner, nameOf(r.status, kPlanStatusNames));
    out += r ? fmt::format("{:>8.4f} {:>8.4g} {:>9.4g} {:>7} {:>8.2f} {:>8} {:>9.2f}",
                           r.report.risk, r.reward, r.utility, r.path.size(), wayLength(r.report),
                           mostContacts(r.report), longestTether(r.report))
             : fmt::format("{:>8} {:>8} {:>9} {:>7} {:>8} {:>8} {:>9}", "-", "-", "-", "-", "-",
                           "-", "-");
    out += fmt::format(" {:>10} {:>10.1f}\n", r.expanded, 1e3 * r.seconds);
  }
  return out;
}

std::string csv(const std::vector<Row>& rows) {
  std::string out =
      "planner,status,risk,reward,utility,states,length_m,contacts,tether_length_m,expanded,time_"
      "ms\n";
  for (const Row& row : rows) {
    const PlanResult& r = row.result;
    out += fmt::format("{},{},", row.planner, nameOf(r.status, kPlanStatusNames));
    out +=
        r ? fmt::format("{},{},{},{},{},{},{}", r.report.risk, r.reward, r.utility, r.path.size(),
                        wayLength(r.report), mostContacts(r.report), longestTether(r.report))
          : std::string(",,,,,,");
    out += fmt::format(",{},{}\n", r.expanded, 1e3 * r.seconds);
  }
  return out;
}

ExitCode run(const Arguments& arguments) {
  TerminalProgress terminal;
  const PlanSpace space = loadPlanSpace(arguments.plan, terminal.progress());
  std::vector<std::string> names = arguments.planners;
  if (names.empty()) {
    for (const PlannerInfo& info : planners()) {
      if (info.name == std::string_view("exact") &&
          space.problem.lattice->freeCount() > kExactCells)
        continue;
      names.emplace_back(info.name);
    }
  }
  std::vector<Row> rows;
  for (const std::string& name : names) {
    if (terminal.cancelled()) break;
    rows.push_back({name, solve(name, space.problem, space.options, terminal.progress())});
  }
  terminal.clear();

  std::vector<DrawnPath> paths;
  bool any = false;
  for (const Row& row : rows) {
    if (row.result) paths.push_back({row.planner, &row.result.report});
    any = any || row.result;
  }
  if (!arguments.csv.empty()) writeFileAtomically(arguments.csv, csv(rows));
  if (!arguments.svg.empty() && any) {
    plot::writeSvg(
        planFigure(fmt::format("{}: planners side by side", space.risk_space.space.map->name),
                   *space.risk_space.space.map, paths, space.rewards),
        arguments.svg);
  }
  if (arguments.json) {
    nlohmann::json out = nlohmann::json::array();
    for (const Row& row : rows) out.push_back(resultJson(row.planner, row.result, space));
    fmt::print("{}\n", out.dump(2));
  } else {
    fmt::print("{}", table(rows));
  }
  if (terminal.cancelled())
    fmt::print(stderr, "tautline-plan: stopped after {} of {} planners\n", rows.size(),
               names.size());
  return any ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addCompareCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb = app.add_subcommand("compare", "Run planners side by side on the same map");
  const auto arguments = std::make_shared<Arguments>();
  arguments->plan.addTo(*verb);
  verb->add_option("--planners", arguments->planners,
                   "Which, separated by commas; default: all, without exact on maps of more than "
                   "40 free cells")
      ->delimiter(',')
      ->type_name("NAME,…");
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  verb->add_option("--csv", arguments->csv, "Write the table")->type_name("FILE");
  verb->add_option("--svg", arguments->svg, "Draw all paths over the map")->type_name("FILE");
  verb->footer(
      "Example: tautline-plan compare --map config/scenes/one_contact.scene.toml --resolution 0.2 "
      "--clearance 0.3 --start 1.5,0.9,2.1 --goal 3.3,1.3,3.5 "
      "--planners additive,directional,tether");
  verb->callback([arguments, &result] { result = run(*arguments); });
}

}  // namespace tautline::planning
