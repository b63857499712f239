/// @file
/// `tautline-plan contacts`: a given path with the tether's contacts and length at every waypoint.

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "common/mission/mission_file.h"
#include "common/plot/figure.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/cli/commands.h"
#include "planning_offline/cli/contact_output.h"
#include "planning_offline/cli/json_values.h"
#include "planning_offline/cli/mission_output.h"
#include "planning_offline/cli/path_file.h"
#include "planning_offline/cli/terminal_progress.h"
#include "planning_offline/cli/workspace.h"
#include "planning_offline/field/reel_place.h"
#include "planning_offline/picture/contact_picture.h"
#include "planning_offline/risk/risk_params.h"
#include "planning_offline/tether/contact_plan.h"
#include "planning_offline/tether/no_contact.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

constexpr double kShortestTether = 1e-3;  // [m]

struct Arguments {
  MapArguments map;
  std::string path;
  ContactOptions options;
  TetherLimits limits;
  double scale{0.0};
  std::string axes;
  bool compare{false};
  bool json{false};
  std::string csv;
  std::string svg;
  std::string output;
};

/// The map's reel, which a mission's must be: the tether is the one that it was made for.
Eigen::Vector3d reelOf(const VoxelMap& map, const GivenPath& path, const std::string& file) {
  constexpr double kSame = 1e-3;  // [m]
  if (!map.reel && !path.reel) {
    throw usage("--reel", "is missing and the map has none", "x,y,z in metres");
  }
  if (map.reel && path.reel && (*map.reel - *path.reel).norm() > kSame) {
    throw InputError({.file = file,
                      .key = "reel_position_m",
                      .problem = fmt::format("is {}, and the reel of the map is at {}",
                                             pointText(*path.reel), pointText(*map.reel)),
                      .allowed = "the same place",
                      .remedy = "correct the mission, or give its reel with --reel x,y,z"});
  }
  return map.reel ? *map.reel : *path.reel;
}

/// The first place on the way where the tether is beyond a hard limit.
class LimitCheck {
 public:
  /// `standoff`: how far contacts are put off their edges [cells].
  LimitCheck(const VoxelMap& map, const TetherLimits& limits, double standoff, std::string file)
      : no_contact_(map), limits_(limits), standoff_(standoff), file_(std::move(file)) {}

  /// Throws InputError (refused).
  void check(const ContactPlan& plan) {
    for (std::size_t i = 0; i < plan.states.size(); ++i) {
      const TetherState& state = plan.states[i];
      for (const ContactEvent& event : state.events) {
        contacts_ += event.kind == ContactChange::kPush ? 1 : -1;
        where_ = event.vehicle == state.position || i == 0
                     ? fmt::format("waypoint {}", i)
                     : fmt::format("on the way to waypoint {}", i);
        checkContacts(event);
        checkLength(event.longest(), event.vehicle);
      }
      where_ = fmt::format("waypoint {}", i);
      checkLength(state.length, state.position);
    }
  }

 private:
  [[noreturn]] void refuse(std::string problem, std::string allowed, std::string remedy) const {
    throw InputError({.file = file_,
                      .key = where_,
                      .problem = std::move(problem),
                      .allowed = std::move(allowed),
                      .remedy = std::move(remedy)},
                     ExitCode::kRefused);
  }

  void checkLength(double length, const Eigen::Vector3d& vehicle) const {
    if (limits_.allowsLength(length)) return;
    refuse(fmt::format("{:.3f} m of tether at {}", length, pointText(vehicle)),
           fmt::format("{:g} m, what the reel holds", limits_.length_max),
           "a shorter way, or a larger --length-max-m if the reel holds more");
  }

  void checkContacts(const ContactEvent& event) const {
    if (event.kind != ContactChange::kPush) return;
    if (no_contact_.touchedAt(event.position, standoff_)) {
      refuse(fmt::format("the tether touches a forbidden surface at {}", pointText(event.position)),
             "no contact there", "fly round it on the other side");
    }
    if (limits_.allowsContacts(contacts_)) return;
    refuse(fmt::format("contact number {} forms at {}", contacts_, pointText(event.position)),
           fmt::format("at most {} at once", limits_.contacts_max),
           "a way with fewer bends, or a larger --contacts-max");
  }

  NoContactCells no_contact_;
  TetherLimits limits_;
  double standoff_;
  std::string file_;
  int contacts_{0};
  std::string where_;
};

json planJson(const ContactPlan& plan, const VoxelMap& map, const Arguments& arguments) {
  json out = {{"algorithm", nameOf(plan.algorithm, kContactAlgorithmNames)},
              {"map", map.name},
              {"frame", "M"},
              {"resolution_m", map.resolution},
              {"reel_m", toJson(*map.reel)},
              {"longest_tether_m", longestTether(plan)},
              {"contacts_formed", countEvents(plan, ContactChange::kPush)},
              {"contacts_released", countEvents(plan, ContactChange::kPop)},
              {"relaxations_refused", nullptr},
              {"tether_through_obstacles", nullptr},
              {"unresolved_moves", plan.unresolved_moves},
              {"settings",
               {{"clearance_m", arguments.map.clearance},
                {"length_max_m", arguments.limits.length_max},
                {"contacts_max", arguments.limits.contacts_max}}},
              {"states", json::array()}};
  const bool published = plan.algorithm == ContactAlgorithm::kAsPublished;
  if (published) {
    out["relaxations_refused"] = refusedRelaxations(plan);
    out["tether_through_obstacles"] = piercingStates(plan);
  }
  for (const TetherState& state : plan.states) {
    json row = published ? publishedTetherJson(state) : tetherJson(state);
    row["position_m"] = toJson(state.position);
    out["states"].push_back(std::move(row));
  }
  return out;
}

/// Throws InputError (refused) for tethers that no mission may carry.
void needFlyableTether(const ContactPlan& plan) {
  const auto refuse = [](std::string problem, std::string remedy) {
    return InputError(
        {.key = "--output", .problem = std::move(problem), .remedy = std::move(remedy)},
        ExitCode::kRefused);
  };
  if (plan.algorithm == ContactAlgorithm::kAsPublished) {
    throw refuse("contacts as published stand off the edges that hold the tether: not to be flown",
                 "--algorithm exact");
  }
  if (plan.unresolved_moves > 0) {
    throw refuse(
        fmt::format("no tether outside all obstacles was found on {} legs", plan.unresolved_moves),
        "a way with more distance from obstacles, or shorter legs");
  }
}

void writeFiles(const Arguments& arguments, const GivenPath& path, const ContactPlan& plan,
                const VoxelMap& map) {
  const std::string title = fmt::format("{}: {}", map.name, contactsSummary(plan));
  std::optional<Mission> mission;  // made first: what cannot be a mission leaves no file behind
  if (!arguments.output.empty()) {
    mission = missionOf(plan, path.orders, map,
                        fmt::format("{} with tether contacts",
                                    std::filesystem::path(arguments.path).filename().string()),
                        arguments.output);
    validateMission(*mission);
  }
  if (!arguments.csv.empty()) writeFileAtomically(arguments.csv, contactsCsv(plan));
  if (!arguments.svg.empty())
    plot::writeSvg(contactFigure(title, map, *map.reel, plan), arguments.svg);
  if (mission) writeMission(*mission, arguments.output);
}

ExitCode compare(const Arguments& arguments, const GivenPath& path, const VoxelMap& map) {
  const ContactComparison both = compareContacts(map, *map.reel, path.points);
  if (!arguments.svg.empty()) {
    plot::writeSvg(
        comparisonFigure(fmt::format("{}: contacts as published and of the taut string", map.name),
                         map, *map.reel, both),
        arguments.svg);
  }
  if (arguments.json) {
    fmt::print("{}\n", comparisonJson(both).dump(2));
    return ExitCode::kOk;
  }
  fmt::print("{}", comparisonText(both));
  if (!arguments.svg.empty()) fmt::print("written: {}\n", arguments.svg);
  return ExitCode::kOk;
}

ExitCode run(const Arguments& arguments) {
  needFinite("--length-max-m", arguments.limits.length_max);
  needFinite("--scale", arguments.scale);
  TerminalProgress terminal;
  const MapSpace space = loadMapSpace(arguments.map, terminal.progress());
  PathFileOptions options;
  options.reel = space.map->reel;
  if (arguments.scale > 0.0) options.legacy.scale = arguments.scale;
  if (!arguments.axes.empty()) options.legacy.axes = parseLegacyAxes(arguments.axes);
  const GivenPath path = readPath(arguments.path, options);
  VoxelMap map = *space.map;
  map.reel = checkedReel(map, reelOf(map, path, arguments.path));
  needFreeWay(path.points, space, arguments.path);
  needStraightStart(map, *map.reel, path.points.front(), arguments.path);
  if (arguments.compare) return compare(arguments, path, map);
  const ContactPlan plan = planContacts(map, *map.reel, path.points, arguments.options);
  const bool exact = plan.algorithm == ContactAlgorithm::kExact;
  LimitCheck(map, arguments.limits, exact ? 0.0 : arguments.options.published.standoff,
             arguments.path)
      .check(plan);
  if (!arguments.output.empty()) needFlyableTether(plan);
  terminal.clear();
  writeFiles(arguments, path, plan, map);
  if (arguments.json) {
    fmt::print("{}\n", planJson(plan, map, arguments).dump(2));
    return ExitCode::kOk;
  }
  fmt::print("{}{}\n", contactsText(plan), contactsSummary(plan));
  for (const std::string* file : {&arguments.csv, &arguments.svg, &arguments.output}) {
    if (!file->empty()) fmt::print("written: {}\n", *file);
  }
  return ExitCode::kOk;
}

}  // namespace

void addContactsCommand(CLI::App& app, ExitCode& result) {
  CLI::App* verb = app.add_subcommand(
      "contacts", "Tether contacts and length along a given path. Exit code 3 beyond a limit");
  const auto arguments = std::make_shared<Arguments>();
  arguments->map.addTo(*verb);
  verb->add_option("--path", arguments->path,
                   "Mission, text with x y z [m] a line in the frame of the map, or legacy path")
      ->required()
      ->type_name("FILE");
  addChoice(*verb, "--algorithm", arguments->options.algorithm, kContactAlgorithmNames,
            "How contacts are found");
  CLI::Option* both = verb->add_flag("--compare", arguments->compare,
                                     "Both algorithms side by side, where they change");
  verb->add_option("--length-max-m", arguments->limits.length_max, "Tether on the reel")
      ->check(CLI::Range(kShortestTether, kFarthestMetres))
      ->excludes(both);
  verb->add_option("--contacts-max", arguments->limits.contacts_max, "Contacts at once")
      ->check(CLI::Range(0, 1000))
      ->excludes(both);
  // What only the limits or one algorithm read.
  for (const char* option : {"--algorithm", "--no-contact"})
    verb->get_option(option)->excludes(both);
  verb->add_option("--scale", arguments->scale, "Metres per unit of a legacy path")
      ->check(CLI::Range(1e-6, kFarthestMetres));
  verb->add_option("--axes", arguments->axes, "Axes of a legacy path, such as yzx");
  verb->add_flag("--json", arguments->json, "Machine-readable output");
  verb->add_option("--csv", arguments->csv, "Write the table of waypoints")
      ->type_name("FILE")
      ->excludes(both);
  verb->add_option("--svg", arguments->svg, "Draw path and tether over the map")->type_name("FILE");
  verb->add_option("-o,--output", arguments->output, "Write the mission")
      ->type_name("FILE.mission.toml")
      ->excludes(both);
  verb->footer(
      "Example: tautline-plan contacts --map config/scenes/one_contact.scene.toml "
      "--path config/missions/one_contact.mission.toml --svg contacts.svg");
  verb->callback([arguments, &result] { result = run(*arguments); });
}

}  // namespace tautline::planning
