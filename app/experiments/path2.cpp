#include "app/experiments/path2.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/experiments/path_trials.h"

namespace tautline::experiments {
namespace {

/// From corner to corner at constant length and elevation: half a circle with half the way as its
/// radius.
constexpr double kFullSemicircle = 2.12;  // [m]
constexpr double kGoal = 0.10;            // [m]

PathPlan planOf(const Setup& setup) {
  const std::uint64_t published = setup.quick ? 1 : 3;
  const std::uint64_t ours = setup.quick ? 4 : 200;
  return {
      .path = "path2", .trials = {published, published, ours}, .limit = std::chrono::seconds(300)};
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
  rows = meanRows(table, Primitive::kPosition, kGoal);
  int growing = 0;
  double worst = 0.0;
  for (std::size_t k = 0; k < kIntervals.size(); ++k) {
    if (k > 0 && position[k].mean > position[k - 1].mean) ++growing;
    worst = std::max(worst, ours[k].max);
  }
  rows.push_back({.figure = "position law, intervals at which it is worse than at the one before",
                  .published = 4.0,
                  .as_published = growing,
                  .as_published_band = Band{4.0, 4.0}});
  rows.push_back(
      {.figure = "position law, largest deviation with two waypoints",
       .unit = "m",
       .as_published = position.back().max,
       .tautline = worst,
       .as_published_band = Band{kFullSemicircle / 2.0, 1.25 * kFullSemicircle},
       .note = "a full semicircle is 2.12 m from the line; ours: largest of all flights"});
  double longest = 0.0;
  double our_longest = 0.0;
  for (std::size_t k = 0; k < kIntervals.size(); ++k) {
    longest = std::max(longest, velocity[k].at_axis);
    our_longest = std::max(our_longest, ours[k].at_axis);
  }
  rows.push_back(
      {.figure = "velocity law, longest stay at the pole",
       .unit = "s",
       .as_published = longest,
       .tautline = our_longest,
       .note = "within 0.35 m of the axis; the noise of the sensors sets it free in the end"});
  const double flown = total(velocity, &PathMeans::flights);
  const double crossings = total(ours, &PathMeans::flights);
  rows.push_back(
      {.figure = "velocity law, flights trapped at the pole",
       .unit = "%",
       .published = 100.0,
       .as_published = 100.0 * total(velocity, &PathMeans::trapped) / flown,
       .as_published_band = Band{100.0, 100.0},
       .note = "trapped: within 0.35 m of the axis for over 14 s, twice the way through"});
  rows.push_back({.figure = fmt::format("paths crossed, of {:g}", crossings),
                  .tautline = total(ours, &PathMeans::completed),
                  .tautline_band = Band{crossings, crossings}});
  addPictures(setup, plan, table, findings);
  return findings;
}

}  // namespace

const Experiment kPath2{"path2", "Motion primitives, path 2",
                        "Level and straight over the reel, from the first quadrant to the third, "
                        "1.5 m up; otherwise as "
                        "path 1. Over the reel azimuth means nothing: the position law flies "
                        "round, the velocity law is "
                        "trapped.",
                        trials, judge};

}  // namespace tautline::experiments
