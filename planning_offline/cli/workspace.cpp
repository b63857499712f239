#include "planning_offline/cli/workspace.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/core.h>

#include "common/error.h"
#include "common/mission/scene.h"
#include "common/toml/config_file.h"
#include "common/toml/toml_file.h"
#include "planning_offline/field/free_space.h"
#include "planning_offline/field/reach.h"
#include "planning_offline/map/raster.h"

namespace tautline::planning {
namespace {

std::vector<double> parseNumbers(const std::string& text, const char* option, std::size_t count,
                                 const char* allowed) {
  std::vector<double> out;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || !std::isfinite(value)) break;
    out.push_back(value);
    at = next;
    if (at == end) break;
    if (*at++ != ',') break;
  }
  if (at != end || out.size() != count) throw usage(option, fmt::format("is '{}'", text), allowed);
  return out;
}

Bounds parseBox(const std::string& text, const char* option) {
  const auto n = parseNumbers(text, option, 6, "x0,y0,z0,x1,y1,z1 in metres");
  const Bounds box{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  if (!(box.min.array() < box.max.array()).all()) {
    throw usage(option, fmt::format("is '{}'", text),
                "lower corner below upper corner in x, y and z");
  }
  return box;
}

/// A box without an obstacle in it would protect nothing: most likely a slip.
void forbidContacts(const std::vector<std::string>& boxes, VoxelMap& map) {
  for (const std::string& text : boxes) {
    const CellRange range = cellsMeeting(map, parseBox(text, "--no-contact"));
    bool any = false;
    forEachCell(map.shape, range, [&](CellIndex i) {
      any = any || map.cells[static_cast<std::size_t>(i)] == CellState::kOccupied;
    });
    if (!any) {
      throw usage("--no-contact",
                  fmt::format("'{}' has no obstacle of the map {} in it", text, map.name),
                  "a box with obstacle cells, in the frame of the map", "see docs/maps.md");
    }
    forbidContact(map, range);
  }
}

/// The cell of a point that the vehicle is to be in; explains why it cannot.
CellIndex cellFor(const Eigen::Vector3d& p, const char* what, const MapSpace& space,
                  const MapArguments& arguments, ExitCode code) {
  const VoxelMap& map = *space.map;
  const CellIndex cell = map.indexAt(p);
  const auto refuse = [&](std::string problem, std::string allowed, std::string remedy) {
    return InputError({.key = what,
                       .problem = std::move(problem),
                       .allowed = std::move(allowed),
                       .remedy = std::move(remedy)},
                      code);
  };
  if (cell == kNoCell) {
    const Eigen::Vector3d end =
        map.origin + map.resolution * Eigen::Vector3d(map.shape.nx, map.shape.ny, map.shape.nz);
    throw refuse(fmt::format("{} is outside the map {}", pointText(p), map.name),
                 fmt::format("{} to {}", pointText(map.origin), pointText(end)), {});
  }
  if (space.lattice->free(cell)) return cell;
  switch (map.cells[static_cast<std::size_t>(cell)]) {
    case CellState::kOccupied:
      throw refuse(fmt::format("{} is inside an obstacle of the map {}", pointText(p), map.name),
                   {}, "choose a free place");
    case CellState::kUnknown:
      throw refuse(fmt::format("{} is in unknown space of the map {}", pointText(p), map.name), {},
                   "choose a known place, or --unknown-free");
    case CellState::kFree:
      break;
  }
  throw refuse(fmt::format("{} is nearer than {:g} m to an obstacle of the map {}", pointText(p),
                           arguments.clearance, map.name),
               {}, "choose a place with more room, or a smaller --clearance");
}

std::vector<Reward> readRewards(const std::string& path) {
  const TomlFile file = TomlFile::load(path);
  TomlTable root = file.root();
  std::vector<Reward> rewards;
  for (TomlTable& row : root.tables("rewards")) {
    Reward reward;
    row.require("position_m", reward.position);
    row.require("value", reward.value, Range{0.0, std::numeric_limits<double>::max()});
    row.finish();
    rewards.push_back(reward);
  }
  root.finish();
  if (rewards.empty())
    throw root.error("rewards", "no rows", "[[rewards]] with position_m and value");
  return rewards;
}

std::vector<double> rewardPerCell(const std::vector<Reward>& rewards, const VoxelMap& map) {
  std::vector<double> out;
  if (!rewards.empty()) out.resize(map.shape.size(), 0.0);
  for (std::size_t i = 0; i < rewards.size(); ++i) {
    const CellIndex cell = map.indexAt(rewards[i].position);
    if (cell == kNoCell) {
      throw InputError({.key = fmt::format("rewards[{}].position_m", i),
                        .problem = fmt::format("{} is outside the map {}",
                                               pointText(rewards[i].position), map.name)});
    }
    if (map.cells[static_cast<std::size_t>(cell)] == CellState::kOccupied) {
      throw InputError({.key = fmt::format("rewards[{}].position_m", i),
                        .problem = fmt::format("{} is inside an obstacle of the map {}",
                                               pointText(rewards[i].position), map.name)});
    }
    out[static_cast<std::size_t>(cell)] += rewards[i].value;
  }
  return out;
}

/// Half-computed maps are worth nothing: ends the program instead.
void stopIfCancelled(const Progress& progress) {
  if (!progress.cancelled()) return;
  throw InputError(
      {.problem = "stopped while the map was prepared, before there was anything to show"},
      ExitCode::kFailed);
}

/// Leaves only the cells that a tether without contacts reaches.
void keepStraightTether(MapSpace& space, const PlanArguments& arguments, CellIndex start,
                        std::optional<CellIndex> goal, const Progress& progress) {
  const VoxelMap& map = *space.map;
  if (!map.reel) throw usage("--straight-tether", "needs a reel", {}, "--reel x,y,z");
  const MapArguments& about = arguments.risk.map;
  const ReachMap reach = computeReach(map, space.lattice->freeCells(), *map.reel,
                                      {.threads = about.threads}, progress);
  stopIfCancelled(progress);
  space.lattice = std::make_unique<Lattice>(map.shape, about.connectivity, reach.straight);
  const auto check = [&](CellIndex cell, const char* what) {
    if (space.lattice->free(cell)) return;
    throw usage("--straight-tether",
                fmt::format("a straight tether from the reel does not reach the {} {}", what,
                            pointText(map.centre(cell))),
                {}, "choose another place, or allow tether contacts");
  };
  check(start, "start");
  if (goal) check(*goal, "goal");
}

RiskSpace withFields(MapSpace space, const RiskParams& params, const FieldRequest& request,
                     const Progress& progress) {
  RiskSpace out{std::move(space), nullptr};
  const VoxelMap& map = *out.space.map;
  MapFields fields = computeFields(map, request, progress);
  stopIfCancelled(progress);
  std::shared_ptr<TautString> string;
  if (map.reel) string = makeTautString(map, *map.reel);
  out.risk =
      std::make_unique<RiskModel>(out.space.map, std::move(fields), params, std::move(string));
  return out;
}

}  // namespace

InputError usage(const char* option, std::string problem, std::string allowed, std::string remedy) {
  return InputError({.key = option,
                     .problem = std::move(problem),
                     .allowed = std::move(allowed),
                     .remedy = std::move(remedy)},
                    ExitCode::kUsage);
}

void needFinite(const char* option, double value) {
  if (!std::isfinite(value)) throw usage(option, "is not a finite number");
}

std::string pointText(const Eigen::Vector3d& p) {
  return fmt::format("({:g}, {:g}, {:g})", p.x(), p.y(), p.z());
}

Eigen::Vector3d parsePoint(const std::string& text, const char* option) {
  const std::vector<double> n = parseNumbers(text, option, 3, "x,y,z in metres, e.g. 1.2,0.4,3");
  return {n[0], n[1], n[2]};
}

void MapArguments::addTo(CLI::App& verb) {
  verb.add_option("--map", map, "OctoMap .bt/.ot, MovingAI .map/.3dmap, or scene .toml")
      ->required()
      ->type_name("FILE");
  verb.add_option("--resolution", resolution, "Edge of a cell [m]; default: the file's own")
      ->check(CLI::Range(1e-4, kFarthestMetres));
  verb.add_option("--crop", crop, "Keep only this box: x0,y0,z0,x1,y1,z1 [m]");
  verb.add_option("--slice", slice, "Plan in the plane at this height y [m]");
  verb.add_option("--clearance", clearance, "Vehicle radius + tolerance kept from obstacles [m]")
      ->check(CLI::Range(0.0, kFarthestMetres));
  verb.add_flag("--unknown-free", unknown_is_free, "Unknown space may be flown through");
  addChoice(verb, "--connectivity", connectivity, kConnectivityNames,
            "Moves over faces (6; 4 in the plane), edges (18; 8) or vertices (26; 8)");
  verb.add_option("--reel", reel, "Reel outlet x,y,z [m]; default: the scene's own");
  verb.add_option(
          "--no-contact", no_contact,
          "The tether must not touch obstacle cells in this box: x0,y0,z0,x1,y1,z1 [m]; may "
          "be repeated")
      ->type_name("BOX")
      ->expected(1)
      ->take_all();
  verb.add_option("--memory-mb", memory_mb, "Largest map [MB]")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  verb.add_option("--threads", threads, "0 = all cores")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
}

MapSpace loadMapSpace(const MapArguments& arguments, const Progress& progress) {
  needFinite("--resolution", arguments.resolution);
  needFinite("--clearance", arguments.clearance);
  LoadOptions options;
  if (arguments.resolution > 0.0) options.resolution = arguments.resolution;
  if (!arguments.crop.empty()) options.crop = parseBox(arguments.crop, "--crop");
  if (!arguments.slice.empty())
    options.slice = parseNumbers(arguments.slice, "--slice", 1, "a height in metres").front();
  options.memory_limit = std::int64_t{arguments.memory_mb} << 20;
  progress.report("reading the map", -1.0);
  VoxelMap map = loadMap(arguments.map, options);
  if (!arguments.reel.empty()) map.reel = parsePoint(arguments.reel, "--reel");
  forbidContacts(arguments.no_contact, map);
  const FreeSpaceOptions free{arguments.clearance, arguments.unknown_is_free, arguments.threads};
  std::vector<std::uint8_t> cells = freeSpace(map, free, progress);
  stopIfCancelled(progress);
  MapSpace space;
  space.lattice = std::make_unique<Lattice>(map.shape, arguments.connectivity, std::move(cells));
  space.map = std::make_shared<const VoxelMap>(std::move(map));
  if (space.lattice->freeCount() == 0) {
    throw InputError({.file = arguments.map,
                      .problem = "has no free cell",
                      .remedy = "a smaller --clearance, or --unknown-free"});
  }
  return space;
}

void RiskArguments::addTo(CLI::App& verb) {
  map.addTo(verb);
  verb.add_option("--params", params,
                  "Risk parameters (TOML); default: config/risk/default.toml's values")
      ->type_name("FILE");
}

RiskSpace makeRiskSpace(MapSpace space, const RiskParams& params, const Progress& progress) {
  FieldRequest request = neededFields(params, *space.map);
  request.unknown_is_obstacle = true;
  return withFields(std::move(space), params, request, progress);
}

RiskSpace loadRiskSpace(const RiskArguments& arguments, const Progress& progress, bool all_fields) {
  const RiskParams params =
      arguments.params.empty() ? RiskParams{} : loadConfig<RiskParams>(arguments.params);
  MapSpace space = loadMapSpace(arguments.map, progress);
  FieldRequest request = neededFields(params, *space.map);
  if (all_fields) {
    request = {.distance = true,
               .width = true,
               .visibility = true,
               .visibility_directions = params.visibility.directions,
               .visibility_cap = params.visibility.cap};
  }
  request.unknown_is_obstacle = !arguments.map.unknown_is_free;
  request.threads = arguments.map.threads;
  return withFields(std::move(space), params, request, progress);
}

void PlanArguments::addTo(CLI::App& verb) {
  risk.addTo(verb);
  verb.add_option("--start", start,
                  "Where the vehicle starts: x,y,z [m]; default: the scene's start");
  verb.add_option("--goal", goal,
                  "Where it is to go: x,y,z [m]; default: the planner chooses among the rewards");
  verb.add_option("--rewards", rewards,
                  "TOML file of [[rewards]] with position_m, value; default: the scene's")
      ->type_name("FILE");
  addChoice(verb, "--objective", objective, kObjectiveNames,
            "What a plan without --goal maximizes");
  verb.add_option("--risk-cap", options.risk_cap, "No path of a higher risk")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb.add_option("--discount", options.discount, "Of the exact planner's reward")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  verb.add_option("--lookback", options.lookback, "States that `lookback` remembers")
      ->check(CLI::Range(2, 4))
      ->capture_default_str();
  verb.add_option("--time-limit-s", options.time_limit, "Of one planner")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb.add_option("--label-limit", options.label_limit, "Labels or paths a planner may hold")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  verb.add_option("--seed", options.seed, "Of everything random")->capture_default_str();
  verb.add_flag("--straight-tether", straight_tether,
                "Only cells that a tether without contacts reaches");
}

PlanSpace loadPlanSpace(const PlanArguments& arguments, const Progress& progress) {
  PlanSpace out;
  out.options = arguments.options;
  out.options.objective = arguments.objective;
  out.options.threads = arguments.risk.map.threads;
  out.risk_space = loadRiskSpace(arguments.risk, progress);
  MapSpace& space = out.risk_space.space;
  const VoxelMap& map = *space.map;
  if (arguments.start.empty() && !map.start)
    throw usage("--start", "is missing and the map has none", "x,y,z in metres");
  out.problem.start = arguments.start.empty()
                          ? cellFor(*map.start, "start_m of the scene", space, arguments.risk.map,
                                    ExitCode::kConfig)
                          : cellFor(parsePoint(arguments.start, "--start"), "--start", space,
                                    arguments.risk.map, ExitCode::kUsage);
  if (!arguments.goal.empty()) {
    out.options.goal = cellFor(parsePoint(arguments.goal, "--goal"), "--goal", space,
                               arguments.risk.map, ExitCode::kUsage);
  }
  if (arguments.straight_tether)
    keepStraightTether(space, arguments, out.problem.start, out.options.goal, progress);
  out.rewards = arguments.rewards.empty() ? map.rewards : readRewards(arguments.rewards);
  out.problem.reward = rewardPerCell(out.rewards, map);
  if (!out.options.goal && out.problem.reward.empty()) {
    throw usage("--goal", "is missing and there are no rewards to choose a goal by",
                "--goal x,y,z, or --rewards FILE");
  }
  out.clearance = arguments.risk.map.clearance;
  out.problem.lattice = space.lattice.get();
  out.problem.risk = out.risk_space.risk.get();
  return out;
}

}  // namespace tautline::planning
