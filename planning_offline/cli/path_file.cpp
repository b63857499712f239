#include "planning_offline/cli/path_file.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/core.h>

#include "common/error.h"
#include "common/mission/mission_file.h"
#include "common/toml/toml_file.h"
#include "planning_offline/field/line_of_sight.h"

namespace tautline::planning {
namespace {

void add(GivenPath& path, const Eigen::Vector3d& point, const Waypoint& orders) {
  if (!path.points.empty() && path.points.back() == point) {
    Waypoint& last = path.orders.back();
    last.hold = std::max(last.hold, orders.hold);
    if (!last.p_WL) last.p_WL = orders.p_WL;
    return;
  }
  path.points.push_back(point);
  path.orders.push_back(orders);
}

/// Whether waypoint i is there only because the contact changes on a straight way.
bool onlyChangesContact(const MissionPlan& plan, int i) {
  constexpr double kStraight = 1e-9;  // [m]
  if (i == 0 || i + 1 == plan.waypoint_count) return false;
  const Waypoint& before = plan.waypoints[static_cast<std::size_t>(i - 1)];
  const Waypoint& here = plan.waypoints[static_cast<std::size_t>(i)];
  const Waypoint& next = plan.waypoints[static_cast<std::size_t>(i + 1)];
  const Eigen::Vector3d in = here.p_WD - before.p_WD;
  const Eigen::Vector3d out = next.p_WD - here.p_WD;
  return next.contact != here.contact && here.hold <= 0.0 && in.dot(out) > 0.0 &&
         in.cross(out).norm() <= kStraight * (in + out).norm();
}

GivenPath pathOf(const Mission& mission, const Eigen::Vector3d& reel, bool states_only) {
  GivenPath path;
  for (int i = 0; i < mission.plan->waypoint_count; ++i) {
    if (states_only && onlyChangesContact(*mission.plan, i)) continue;
    const Waypoint& waypoint = mission.plan->waypoints[static_cast<std::size_t>(i)];
    add(path, waypoint.p_WD + reel, waypoint);
  }
  return path;
}

/// The line without its comment, with spaces for what stands between numbers.
std::string plainLine(std::string line) {
  line = line.substr(0, line.find('#'));
  for (char& c : line) c = c == ',' || c == '\r' ? ' ' : c;
  return line;
}

/// Words in the first line that has any.
std::size_t columnsOf(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    std::istringstream words(plainLine(line));
    std::size_t count = 0;
    for (std::string word; words >> word && word.front() != '%';) ++count;
    if (count > 0) return count;
  }
  return 0;
}

GivenPath pathOfPoints(const std::string& text, const std::string& file) {
  GivenPath path;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream fields(plainLine(line));
    Eigen::Vector3d p;
    fields >> std::ws;
    if (fields.eof()) continue;
    if (!(fields >> p.x() >> p.y() >> p.z()) || !p.allFinite() || !(fields >> std::ws).eof()) {
      throw InputError({.file = file,
                        .line = number,
                        .problem = fmt::format("is '{}'", plainLine(line)),
                        .allowed = "x y z in metres, in every line"});
    }
    add(path, p, {});
  }
  if (path.points.empty()) {
    throw InputError({.file = file,
                      .problem = "has no point",
                      .allowed = "x y z in metres, one point a line, or a mission"});
  }
  return path;
}

void refuseLegacyOptions(const std::string& file, const LegacyOptions& legacy) {
  if (!legacy.scale && !legacy.axes) return;
  throw InputError({.file = file,
                    .key = legacy.scale ? "--scale" : "--axes",
                    .problem = "is for files of 6 or 9 numbers a line, this is none",
                    .remedy = "leave it out"},
                   ExitCode::kUsage);
}

}  // namespace

GivenPath readPath(const std::string& file, const PathFileOptions& options) {
  if (file.ends_with(".toml")) {
    refuseLegacyOptions(file, options.legacy);
    const Mission mission = readMission(file);
    GivenPath path = pathOf(mission, mission.reel_position, options.states_only);
    path.reel = mission.reel_position;
    return path;
  }
  const std::string text = readTextFile(file);
  const std::size_t columns = columnsOf(text);
  if (columns != 6 && columns != 9) {
    refuseLegacyOptions(file, options.legacy);
    return pathOfPoints(text, file);
  }
  if (!options.reel) {
    throw InputError({.file = file,
                      .problem = fmt::format("has {} numbers a line: its points are relative to "
                                             "the reel, and the map has none",
                                             columns),
                      .remedy = "--reel x,y,z"},
                     ExitCode::kUsage);
  }
  return pathOf(parseLegacyMission(text, file, options.legacy), *options.reel, options.states_only);
}

void needFreeWay(const std::vector<Eigen::Vector3d>& path, const MapSpace& space,
                 const std::string& file) {
  const VoxelMap& map = *space.map;
  needSightSize(map);
  std::vector<std::uint8_t> blocked;
  for (const std::uint8_t free : space.lattice->freeCells()) blocked.push_back(free != 0 ? 0 : 1);
  const auto cells = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return (p - map.origin) / map.resolution;
  };
  for (std::size_t i = 0; i < path.size(); ++i) {
    const CellIndex cell = map.indexAt(path[i]);
    if (cell == kNoCell || !space.lattice->free(cell)) {
      throw InputError({.file = file,
                        .key = fmt::format("waypoint {}", i),
                        .problem = fmt::format(
                            "{} is {} the map {}", pointText(path[i]),
                            cell == kNoCell ? "outside" : "not in the free space of", map.name)});
    }
    if (i > 0 && !outsideSolids(map.shape, blocked, cells(path[i - 1]), cells(path[i]))) {
      throw InputError(
          {.file = file,
           .key = fmt::format("waypoints {} to {}", i - 1, i),
           .problem = fmt::format("the way from {} to {} leaves the free space of the map {}",
                                  pointText(path[i - 1]), pointText(path[i]), map.name)});
    }
  }
}

void needStraightStart(const VoxelMap& map, const Eigen::Vector3d& reel,
                       const Eigen::Vector3d& start, const std::string& file) {
  needSightSize(map);
  std::vector<std::uint8_t> blocked;
  for (const CellState state : map.cells) blocked.push_back(state == CellState::kOccupied ? 1 : 0);
  const Eigen::Vector3d from = (reel - map.origin) / map.resolution;
  const Eigen::Vector3d to = (start - map.origin) / map.resolution;
  const bool near = (from.array().abs() <= kSightFarthest).all();
  if (near && outsideSolids(map.shape, blocked, from, to)) return;
  const bool planned = file.empty();
  throw InputError(
      {.file = file,
       .key = planned ? "--start" : "waypoint 0",
       .problem = fmt::format("{} is not in a straight line from the reel {}: {}", pointText(start),
                              pointText(reel),
                              near ? "an obstacle is between them" : "the reel is too far away"),
       .allowed = "a place that a straight tether reaches",
       .remedy = planned ? "" : "begin the path where the vehicle takes off"},
      planned ? ExitCode::kUsage : ExitCode::kConfig);
}

}  // namespace tautline::planning
