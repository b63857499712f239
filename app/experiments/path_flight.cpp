#include "app/experiments/path_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "common/mission/mission_file.h"
#include "common/mission/scene.h"

namespace tautline::experiments {
namespace {

constexpr double kSpacing = 0.1;  // [m]

std::filesystem::path missionFile(const Setup& setup, const std::string& path, double interval) {
  return setup.folder / fmt::format("../missions/{}_{:g}.mission.toml", path, interval);
}

Law lawOf(Primitive primitive) noexcept {
  switch (primitive) {
    case Primitive::kPosition:
      return Law::kPosition;
    case Primitive::kVelocity:
      return Law::kVelocity;
    case Primitive::kTautline:
      break;
  }
  return Law::kComposite;
}

double longestStayAtAxis(const std::vector<TrackPoint>& track) {
  double longest = 0.0;
  double since = 0.0;
  for (std::size_t i = 0; i < track.size(); ++i) {
    const bool near = std::hypot(track[i].p_WD.x(), track[i].p_WD.z()) < kAxisReach;
    if (!near || i == 0) since = track[i].t;
    longest = std::max(longest, track[i].t - since);
  }
  return longest;
}

std::vector<Eigen::Vector3d> withoutHeight(std::vector<Eigen::Vector3d> points) {
  for (Eigen::Vector3d& p : points) p.y() = 0.0;
  return points;
}

}  // namespace

const char* nameOf(Primitive primitive) noexcept {
  switch (primitive) {
    case Primitive::kPosition:
      return "position";
    case Primitive::kVelocity:
      return "velocity";
    case Primitive::kTautline:
      break;
  }
  return "Tautline";
}

plot::Colour colourOf(Primitive primitive) noexcept {
  switch (primitive) {
    case Primitive::kPosition:
      return plot::Colour::kVermilion;
    case Primitive::kVelocity:
      return plot::Colour::kGreen;
    case Primitive::kTautline:
      break;
  }
  return plot::Colour::kBlue;
}

std::string pathTrial(const std::string& path, Primitive primitive, double interval,
                      std::uint64_t trial) {
  return fmt::format("{} {} {:g} m #{}", path, nameOf(primitive), interval, trial);
}

std::vector<Eigen::Vector3d> pathCorners(const Setup& setup, const std::string& path) {
  const Mission mission = readMission(missionFile(setup, path, kIntervals.back()));
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < mission.plan->waypoint_count; ++i)
    corners.push_back(mission.plan->waypoints[static_cast<std::size_t>(i)].p_WD);
  return corners;
}

std::vector<Eigen::Vector3d> resampled(const std::vector<Eigen::Vector3d>& track, double spacing) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& p : track)
    if (points.empty() || (p - points.back()).norm() >= spacing) points.push_back(p);
  return points;
}

double meanTurn(const std::vector<Eigen::Vector3d>& points) {
  if (points.size() < 3) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 2; i < points.size(); ++i) {
    const Eigen::Vector3d a = points[i - 1] - points[i - 2];
    const Eigen::Vector3d b = points[i] - points[i - 1];
    sum += std::atan2(a.cross(b).norm(), a.dot(b));
  }
  return sum / static_cast<double>(points.size() - 2) * 180.0 / std::numbers::pi;
}

double bulge(const std::vector<Eigen::Vector3d>& track) {
  if (track.size() < 3) return 0.0;
  const std::vector<Eigen::Vector3d> flat = withoutHeight(track);
  double largest = 0.0;
  for (const Eigen::Vector3d& p : flat)
    largest = std::max(largest, crossTrack(p, {flat.front(), flat.back()}));
  return largest;
}

nlohmann::json flyPath(const Setup& setup, Primitive primitive, const std::string& path,
                       double interval, std::uint64_t trial, Duration limit, bool keep_track) {
  StationConfig station = primitive == Primitive::kTautline ? setup.tautline : setup.as_published;
  station.core.control.law = lawOf(primitive);
  const Scene world = sceneInWorld(readScene(setup.folder / "../scenes/open.scene.toml"));
  const Mission mission = readMission(missionFile(setup, path, interval));
  // Speed is the set-up's, as for every mission of the experiments.
  for (int i = 0; i < mission.plan->waypoint_count; ++i)
    mission.plan->waypoints[static_cast<std::size_t>(i)].speed = 0.0;
  const TrackedFlight flight =
      flyTracked(setup.flight(station, world, trial), *mission.plan, limit);
  const std::vector<Eigen::Vector3d> corners = pathCorners(setup, path);
  // On its way to the first waypoint the drone is not on the path yet.
  std::vector<Eigen::Vector3d> flown, first_leg;
  const Eigen::Vector3d first_end = corners[1];
  double sum = 0.0;
  double largest = 0.0;
  for (const TrackPoint& p : flight.track) {
    if (p.waypoint < 1) continue;
    flown.push_back(p.p_WD);
    const auto& target = mission.plan->waypoints[static_cast<std::size_t>(p.waypoint)].p_WD;
    const bool on_first = (target - corners[0]).norm() <= (first_end - corners[0]).norm() + 1e-6 &&
                          crossTrack(target, {corners[0], first_end}) < 1e-6;
    if (on_first) first_leg.push_back(p.p_WD);
    const double off = crossTrack(p.p_WD, corners);
    sum += off;
    largest = std::max(largest, off);
  }
  const std::vector<Eigen::Vector3d> points = resampled(flown, kSpacing);
  nlohmann::json out = {{"completed", flight.result.completed},
                        {"reasons", flight.reasons},
                        {"mean", flown.empty() ? 0.0 : sum / static_cast<double>(flown.size())},
                        {"max", largest},
                        {"turn", meanTurn(points)},
                        {"bulge", bulge(first_leg)},
                        {"at_axis", longestStayAtAxis(flight.track)},
                        {"track", nlohmann::json::array()}};
  if (!keep_track) return out;
  const auto round = [](double v) { return std::round(1000.0 * v) / 1000.0; };
  for (const Eigen::Vector3d& p : points)
    out["track"].push_back({round(p.x()), round(p.y()), round(p.z())});
  return out;
}

PathFigures pathFigures(const nlohmann::json& json) {
  PathFigures f{.completed = json.at("completed"),
                .reasons = json.at("reasons"),
                .mean = json.at("mean"),
                .max = json.at("max"),
                .turn = json.at("turn"),
                .bulge = json.at("bulge"),
                .at_axis = json.at("at_axis"),
                .track = {}};
  for (const nlohmann::json& p : json.at("track")) f.track.emplace_back(p.at(0), p.at(1), p.at(2));
  return f;
}

plot::Panel trackPanel(const std::string& title, const std::vector<Eigen::Vector3d>& ideal,
                       const std::vector<DrawnTrack>& tracks) {
  plot::Panel panel{
      .title = title, .x = {.label = "z [m]"}, .y = {.label = "x [m]"}, .equal_aspect = true};
  const auto fromAbove = [](const std::vector<Eigen::Vector3d>& points) {
    std::vector<plot::Point> out;
    out.reserve(points.size());
    for (const Eigen::Vector3d& p : points) out.push_back({p.z(), p.x()});
    return out;
  };
  panel.series.push_back({.name = "planned",
                          .points = fromAbove(ideal),
                          .style = plot::Style::kDashed,
                          .colour = plot::Colour::kBlack,
                          .width = 1.2});
  for (const DrawnTrack& track : tracks) {
    panel.series.push_back({.name = nameOf(track.primitive),
                            .points = fromAbove(track.points),
                            .colour = colourOf(track.primitive)});
  }
  panel.markers.push_back({.at = {0.0, 0.0}, .label = "reel", .symbol = plot::Symbol::kTriangle});
  return panel;
}

}  // namespace tautline::experiments
