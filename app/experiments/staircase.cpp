#include "app/experiments/staircase.h"

#include <array>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "app/experiments/staircase_paths.h"
#include "app/experiments/staircase_pull.h"
#include "common/plot/views.h"

namespace tautline::experiments {
namespace {

constexpr std::int64_t kQuickFlights = 20;
constexpr std::int64_t kWholeFlights = 10000;

std::int64_t flightsOf(const Setup& setup) { return setup.quick ? kQuickFlights : kWholeFlights; }

std::vector<Trial> trials(const Setup& setup) {
  const std::shared_ptr<const Stairs> stairs = planStairs(setup);
  std::vector<Trial> all = stairTrials(setup, stairs, flightsOf(setup));
  for (Trial& trial : stairPullTrials(setup, stairs)) all.push_back(std::move(trial));
  return all;
}

/// Places are sorted by state of the path: where most flights end is where to look.
Sheet endsSheet(const StairTallies& tallies) {
  Sheet sheet{"ends", {"<station", "<path", "<end", "waypoint", "flights"}, {}};
  forEachStairs([&](std::size_t station, std::size_t v) {
    std::map<std::pair<std::string, int>, int> counts;
    for (const FlightVerdict& verdict : tallies[station][v].verdicts) {
      std::string end = nameOf(verdict.end, kFlightEndNames);
      if (verdict.end == FlightEnd::kAborted) end += " (" + verdict.why + ")";
      ++counts[{end, verdict.waypoint}];
    }
    for (const auto& [what, count] : counts)
      sheet.rows.push_back({kStationNames[station], kViewpoints[v].name, what.first,
                            std::to_string(what.second), std::to_string(count)});
  });
  return sheet;
}

Sheet successSheet(const StairTallies& tallies) {
  Sheet sheet{
      "success", {"<station", "<path", "flights", "finished", "success", "95 % from", "to"}, {}};
  forEachStairs([&](std::size_t station, std::size_t v) {
    const CampaignTally& t = tallies[station][v];
    const std::int64_t finished = t.flights() - t.failed();
    const Interval i = clopperPearson(finished, t.flights());
    sheet.rows.push_back({kStationNames[station], kViewpoints[v].name, std::to_string(t.flights()),
                          std::to_string(finished), fmt::format("{:.4f}", t.finishedShare()),
                          fmt::format("{:.4f}", i.low), fmt::format("{:.4f}", i.high)});
  });
  return sheet;
}

Picture flightsPicture(const Stairs& stairs, const Results& results, std::size_t station) {
  plot::Drawing drawing;
  drawing.title = fmt::format("Staircase, {}: planned and flown", kStationNames[station]);
  plot::addScene(drawing, stairs.flights[station][0].world);
  for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
    plot::SpaceCurve planned{.name = fmt::format("{}, planned", kViewpoints[v].name),
                             .points = {},
                             .style = plot::Style::kLinePoints,
                             .colour = kViewpoints[v].colour,
                             .width = 2.0};
    for (const Eigen::Vector3d& p : stairs.paths[v].points)
      planned.points.push_back(p - *stairs.space.space.map->reel);
    drawing.curves.push_back(std::move(planned));
    const nlohmann::json& trial = results.at(stairTrialName(station, v, 0));
    for (std::size_t flight = 0; flight < 5 && flight < trial.at("tracks").size(); ++flight) {
      plot::SpaceCurve flown{
          .name = flight == 0 ? fmt::format("{}, flown (five flights)", kViewpoints[v].name)
                              : std::string(),
          .points = {},
          .colour = v == 0 ? plot::Colour::kOrange : plot::Colour::kBlue,
          .width = 0.8};
      for (const auto& p : trial.at("tracks").at(flight))
        flown.points.emplace_back(p.at(0), p.at(1), p.at(2));
      drawing.curves.push_back(std::move(flown));
    }
  }
  return {fmt::format("flights_{}", station == 0 ? "as_published" : "tautline"),
          "Planned paths to both viewpoints and the true ways of the first five flights of each; "
          "obstacles are the things that are flown round.",
          plot::viewsFigure(drawing)};
}

/// The published correction takes no account of the pull, which makes one and the same error of all
/// flights of a path.
std::string whyPublishedMisses(const Setup& setup, double share, const Band& band) {
  if (band.has(share)) return "";
  return fmt::format(
      "the published correction does not know the pull: with {:g} N it makes one and the same "
      "error of all flights of a path, which here {}; the picture shows success over the pull, "
      "rough_air the published shares",
      setup.plant.vehicle.tension,
      share > band.max ? "leads past everything" : "leaves them too low over the floor");
}

Findings judge(const Setup& setup, const Results& results) {
  const std::shared_ptr<const Stairs> stairs = planStairs(setup);
  const StairTallies tallies = stairTallies(results, flightsOf(setup));
  Findings findings;
  for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
    const Viewpoint& view = kViewpoints[v];
    const double risk = stairs->paths[v].prediction.risk;
    // Published to three digits: half of the last one.
    const auto printed = [](double x) { return Band{x - 0.0005, x + 0.0005}; };
    findings.rows.push_back({.figure = fmt::format("{}: risk of the path", view.name),
                             .published = view.risk,
                             .tautline = risk,
                             .tautline_band = printed(view.risk)});
    findings.rows.push_back({.figure = fmt::format("{}: utility", view.name),
                             .published = view.utility,
                             .tautline = view.reward / risk,
                             // Published from the rounded risk.
                             .tautline_band = Band{view.reward / (view.risk + 0.0005) - 0.0005,
                                                   view.reward / (view.risk - 0.0005) + 0.0005}});
    Row success = successRow(view, tallies[0][v], tallies[1][v]);
    success.tautline_band = Band{.min = view.wanted};
    if (tallies[1][v].finishedShare() >= view.wanted) {
      success.shortfall =
          whyPublishedMisses(setup, *success.as_published, *success.as_published_band);
    }
    findings.rows.push_back(std::move(success));
  }
  findings.sheets.push_back(successSheet(tallies));
  findings.sheets.push_back(endsSheet(tallies));
  for (std::size_t station = 0; station < kStationNames.size(); ++station)
    findings.pictures.push_back(flightsPicture(*stairs, results, station));
  addStairPulls(setup, results, findings);
  return findings;
}

}  // namespace

const Experiment kStaircase{
    "staircase", "Staircase: both viewpoints",
    "The paths of least risk to both viewpoints of the staircase, planned by our planner in the "
    "dissertation's voxels, each flown many times. The voxels are the real things grown by the "
    "vehicle's radius (0.15 m), so the plant's solids are thinner by that on each side. A flight "
    "is finished if its mission is flown without touching anything and the drone truly ends within "
    "0.7 m of the viewpoint. Both are flown again with other pulls on the tether.",
    trials, judge};

}  // namespace tautline::experiments
