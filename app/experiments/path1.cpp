#include "app/experiments/path1.h"

#include <algorithm>

#include "app/experiments/path_trials.h"

namespace tautline::experiments {
namespace {

/// The first leg's ends are equally far from the reel, 2.12 m on the level and 3 m apart: at
/// constant length and elevation the drone flies a circle, 0.62 m outside the straight line.
constexpr double kFullArc = 0.62;  // [m]
constexpr double kGoal = 0.08;     // [m]

PathPlan planOf(const Setup& setup) {
  const std::uint64_t trials = setup.quick ? 1 : 3;
  return {.path = "path1", .trials = {trials, trials, trials}, .limit = std::chrono::seconds(400)};
}

std::vector<Trial> trials(const Setup& setup) { return pathTrials(setup, planOf(setup)); }

Findings judge(const Setup& setup, const Results& results) {
  const PathPlan plan = planOf(setup);
  const PathTable table = pathTable(plan, results);
  const auto& position = of(table, Primitive::kPosition);
  const auto& velocity = of(table, Primitive::kVelocity);
  const auto& ours = of(table, Primitive::kTautline);
  Findings findings;
  std::vector<Row>& rows = findings.rows;
  const auto completed = [](const auto&... laws) {
    return 100.0 * (total(laws, &PathMeans::completed) + ...) /
           (total(laws, &PathMeans::flights) + ...);
  };
  rows.push_back({.figure = "paths flown to their end",
                  .unit = "%",
                  .published = 100.0,
                  .as_published = completed(position, velocity),
                  .tautline = completed(ours),
                  .as_published_band = Band{100.0, 100.0},
                  .tautline_band = Band{100.0, 100.0}});
  for (const Row& row : meanRows(table, Primitive::kPosition, kGoal)) rows.push_back(row);
  for (const Row& row : meanRows(table, Primitive::kVelocity, {})) rows.push_back(row);
  const auto spread = [](const std::array<PathMeans, kIntervals.size()>& law) {
    const auto [least, most] = std::minmax_element(
        law.begin(), law.end(), [](const auto& a, const auto& b) { return a.mean < b.mean; });
    return most->mean - least->mean;
  };
  rows.push_back({.figure = "velocity law, most minus least over the intervals",
                  .unit = "m",
                  .as_published = spread(velocity),
                  .tautline = spread(ours),
                  .as_published_band = Band{.max = 0.1},
                  .note = "published: not very sensitive to the density of waypoints"});
  rows.push_back({.figure = "position law, arc of the first leg at 3 m",
                  .unit = "m",
                  .as_published = position.back().bulge,
                  .tautline = ours.back().bulge,
                  .as_published_band = Band{kFullArc / 2.0, 2.0 * kFullArc},
                  .tautline_band = Band{.max = kFullArc / 4.0},
                  .note = "the circle of constant length is 0.62 m outside the straight line"});
  rows.push_back({.figure = "velocity law, arc of the first leg at 3 m",
                  .unit = "m",
                  .as_published = velocity.back().bulge,
                  .tautline = ours.back().bulge,
                  .as_published_band = Band{.max = kFullArc / 2.0}});
  rows.push_back({.figure = "position law, turn at 3 m over turn at 0.2 m",
                  .as_published = position.back().turn / position.front().turn,
                  .tautline = ours.back().turn / ours.front().turn,
                  .as_published_band = Band{.max = 1.0},
                  .note = "published: smoother with sparser waypoints"});
  rows.push_back({.figure = "velocity law, turn at 3 m over turn at 0.2 m",
                  .as_published = velocity.back().turn / velocity.front().turn,
                  .tautline = ours.back().turn / ours.front().turn,
                  .as_published_band = Band{.max = 1.0},
                  .note = "published: smoother with sparser waypoints"});
  addPictures(setup, plan, table, findings);
  return findings;
}

}  // namespace

const Experiment kPath1{
    "path1", "Motion primitives, path 1",
    "A level leg of 3 m, a corner, a climbing leg; waypoints every 0.2 to 3 m; the published "
    "position "
    "and velocity laws on the published station with its straight tether, ours on ours. "
    "Cross-track "
    "error of the true position from the first waypoint to the end; smoothness is the mean angle "
    "between consecutive pieces of 0.1 m of the flown track.",
    trials, judge};

}  // namespace tautline::experiments
