#include "app/cli/mission_command.h"

#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "app/cli/mission_svg_command.h"
#include "common/mission/legacy_import.h"
#include "common/mission/mission_check.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"
#include "common/tether_geometry.h"
#include "common/toml/config_file.h"

namespace tautline::cli {
namespace {

using nlohmann::json;

constexpr double kDegree = std::numbers::pi / 180.0;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

json toJson(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

std::string summary(const Mission& mission) {
  const MissionPlan& plan = *mission.plan;
  return fmt::format("{}: {} waypoint{}, {} contact{}, hash {}", mission.name, plan.waypoint_count,
                     plan.waypoint_count == 1 ? "" : "s", plan.contact_count,
                     plan.contact_count == 1 ? "" : "s", hashText(plan.hash));
}

json summaryJson(const Mission& mission) {
  return {{"name", mission.name},
          {"description", mission.description},
          {"frame", mission.frame},
          {"reel_position_m", toJson(mission.reel_position)},
          {"map", mission.map},
          {"map_hash", mission.map_hash},
          {"hash", hashText(mission.plan->hash)},
          {"waypoint_count", mission.plan->waypoint_count},
          {"contact_count", mission.plan->contact_count}};
}

struct CheckArguments {
  std::string file;
  std::string scene;
  std::string limits;
  bool json{false};
};

ExitCode runCheck(const CheckArguments& arguments) {
  const Mission mission = readMission(arguments.file);
  const auto limits =
      arguments.limits.empty() ? MissionLimits{} : loadConfig<MissionLimits>(arguments.limits);
  const std::optional<Scene> scene = findScene(mission, arguments.file, arguments.scene);
  const std::vector<MissionFinding> findings =
      checkMission(mission, limits, scene ? &*scene : nullptr);
  const bool flyable = isFlyable(findings);
  if (arguments.json) {
    json out = summaryJson(mission);
    out["file"] = arguments.file;
    out["scene"] = scene ? json(scene->name) : json(nullptr);
    out["flyable"] = flyable;
    out["findings"] = json::array();
    for (const MissionFinding& finding : findings) {
      out["findings"].push_back({{"severity", nameOf(finding.severity, kFindingSeverityNames)},
                                 {"row", finding.row},
                                 {"text", finding.text},
                                 {"remedy", finding.remedy}});
    }
    fmt::print("{}\n", out.dump(2));
  } else {
    fmt::print("{}\n", summary(mission));
    fmt::print("scene: {}\n", scene ? scene->name : "none, obstacles not checked");
    for (const MissionFinding& finding : findings) {
      fmt::print("{}: {}{}{}{}\n", nameOf(finding.severity, kFindingSeverityNames),
                 finding.row.empty() ? "" : finding.row + ": ", finding.text,
                 finding.remedy.empty() ? "" : "; ", finding.remedy);
    }
    fmt::print("{}\n", flyable ? "flyable" : "NOT flyable");
  }
  return flyable ? ExitCode::kOk : ExitCode::kConfig;
}

struct ImportArguments {
  std::string file;
  std::string output;
  std::string axes;
  LegacyOptions options;
  bool json{false};
};

ExitCode runImport(ImportArguments arguments) {
  if (!arguments.axes.empty()) arguments.options.axes = parseLegacyAxes(arguments.axes);
  Mission mission = importLegacyMission(arguments.file, arguments.options);
  writeMission(mission, arguments.output);
  if (arguments.json) {
    json out = summaryJson(mission);
    out["file"] = arguments.output;
    fmt::print("{}\n", out.dump(2));
  } else {
    fmt::print("{}\nwritten to {}\n", summary(mission), arguments.output);
  }
  return ExitCode::kOk;
}

/// One waypoint as `show` prints it: seen from its active anchor, with everything straight.
struct ShownWaypoint {
  TetherCoordinates tether;
  double tether_total{0.0};  ///< [m]
  double path_length{0.0};   ///< Flown since waypoint 0 [m].
};

std::vector<ShownWaypoint> shownWaypoints(const MissionPlan& plan) {
  const std::vector<std::vector<int>> stacks = contactStacks(plan);
  std::vector<ShownWaypoint> rows;
  double path_length = 0.0;
  for (int i = 0; i < plan.waypoint_count; ++i) {
    const Waypoint& waypoint = plan.waypoints[at(i)];
    if (i > 0) path_length += (waypoint.p_WD - plan.waypoints[at(i - 1)].p_WD).norm();
    const TetherCoordinates tether =
        toTether(waypoint.p_WD - anchorPosition(plan, waypoint.contact));
    rows.push_back({tether, staticLength(plan, stacks[at(i)]) + tether.L, path_length});
  }
  return rows;
}

void showJson(const Mission& mission) {
  const MissionPlan& plan = *mission.plan;
  const std::vector<ShownWaypoint> rows = shownWaypoints(plan);
  json out = summaryJson(mission);
  out["contacts"] = json::array();
  for (int i = 0; i < plan.contact_count; ++i) {
    out["contacts"].push_back(
        {{"id", plan.contacts[at(i)].id}, {"position_m", toJson(plan.contacts[at(i)].p_WC)}});
  }
  out["waypoints"] = json::array();
  for (int i = 0; i < plan.waypoint_count; ++i) {
    const Waypoint& waypoint = plan.waypoints[at(i)];
    json row = {{"position_m", toJson(waypoint.p_WD)},
                {"contact", waypoint.contact},
                {"free_length_m", rows[at(i)].tether.L},
                {"elevation_rad", rows[at(i)].tether.theta},
                {"azimuth_rad", rows[at(i)].tether.phi},
                {"tether_length_m", rows[at(i)].tether_total},
                {"path_length_m", rows[at(i)].path_length},
                {"speed_mps", waypoint.speed},
                {"hold_s", waypoint.hold},
                {"risk", waypoint.risk}};
    if (waypoint.p_WL) row["look_at_m"] = toJson(*waypoint.p_WL);
    out["waypoints"].push_back(row);
  }
  fmt::print("{}\n", out.dump(2));
}

void showTable(const Mission& mission) {
  const MissionPlan& plan = *mission.plan;
  const std::vector<ShownWaypoint> rows = shownWaypoints(plan);
  fmt::print("{}\n", summary(mission));
  if (!mission.description.empty()) fmt::print("{}\n", mission.description);
  for (int i = 0; i < plan.contact_count; ++i) {
    const MissionContact& contact = plan.contacts[at(i)];
    fmt::print("contact {} at {:.3f} {:.3f} {:.3f} m\n", contact.id, contact.p_WC.x(),
               contact.p_WC.y(), contact.p_WC.z());
  }
  fmt::print("{:>5} {:>8} {:>8} {:>8} {:>7} {:>7} {:>7} {:>8} {:>8} {:>6} {:>6} {:>8}\n", "row",
             "x [m]", "y [m]", "z [m]", "contact", "L [m]", "theta", "phi [deg]", "tether",
             "v[m/s]", "hold", "path [m]");
  for (int i = 0; i < plan.waypoint_count; ++i) {
    const Waypoint& waypoint = plan.waypoints[at(i)];
    const ShownWaypoint& row = rows[at(i)];
    fmt::print(
        "{:>5} {:>8.3f} {:>8.3f} {:>8.3f} {:>7} {:>7.3f} {:>7.1f} {:>9.1f} {:>8.3f} {:>6} {:>6.1f} "
        "{:>8.2f}\n",
        i, waypoint.p_WD.x(), waypoint.p_WD.y(), waypoint.p_WD.z(), waypoint.contact, row.tether.L,
        row.tether.theta / kDegree, row.tether.phi / kDegree, row.tether_total,
        waypoint.speed > 0.0 ? fmt::format("{:.2f}", waypoint.speed) : "-", waypoint.hold,
        row.path_length);
  }
}

void addCheck(CLI::App& mission, ExitCode& result) {
  CLI::App* verb = mission.add_subcommand("check", "Can this mission be flown? Exit code 5 if not");
  const auto arguments = std::make_shared<CheckArguments>();
  verb->add_option("file", arguments->file, "Mission file (*.mission.toml)")->required();
  verb->add_option("--scene", arguments->scene,
                   "Scene to check against; default: the mission's own map");
  verb->add_option("--limits", arguments->limits,
                   "TOML file with other limits than the built-in ones");
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  verb->footer("Example: tautline mission check config/missions/one_contact.mission.toml --json");
  verb->callback([arguments, &result] { result = runCheck(*arguments); });
}

void addImport(CLI::App& mission, ExitCode& result) {
  CLI::App* verb =
      mission.add_subcommand("import", "Convert a legacy path of 6 or 9 numbers a line");
  const auto arguments = std::make_shared<ImportArguments>();
  verb->add_option("file", arguments->file, "Legacy text file")->required();
  verb->add_option("-o,--output", arguments->output, "Mission file to write")->required();
  verb->add_option("--name", arguments->options.name, "Name of the mission; default: the file's");
  verb->add_option("--scale", arguments->options.scale,
                   "Metres per unit; default: 1 (9 numbers) or 0.33 (6 numbers)")
      ->check(CLI::PositiveNumber);
  verb->add_option("--axes", arguments->axes,
                   "Which of the file's axes become x, y, z, '-' negates; default: xyz (9 numbers) "
                   "or yzx (6 numbers)");
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  verb->footer(
      "Example: tautline mission import Relaxation.txt -o relaxation.mission.toml --scale 0.33 "
      "--axes yzx");
  verb->callback([arguments, &result] { result = runImport(*arguments); });
}

void addShow(CLI::App& mission, ExitCode& result) {
  CLI::App* verb = mission.add_subcommand(
      "show", "Waypoints with tether length, elevation and azimuth as seen from the active anchor");
  const auto file = std::make_shared<std::string>();
  const auto as_json = std::make_shared<bool>(false);
  verb->add_option("file", *file, "Mission file (*.mission.toml)")->required();
  verb->add_flag("--json", *as_json, "Machine-readable output");
  verb->footer("Example: tautline mission show config/missions/square.mission.toml");
  verb->callback([file, as_json, &result] {
    const Mission shown = readMission(*file);
    *as_json ? showJson(shown) : showTable(shown);
    result = ExitCode::kOk;
  });
}

}  // namespace

void addMissionCommand(CLI::App& root, ExitCode& result) {
  CLI::App* mission = root.add_subcommand("mission", "Check, import, show and draw mission files");
  mission->require_subcommand(1);
  addCheck(*mission, result);
  addImport(*mission, result);
  addShow(*mission, result);
  addMissionSvgCommand(*mission, result);
}

}  // namespace tautline::cli
