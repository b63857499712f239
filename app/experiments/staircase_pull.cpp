#include "app/experiments/staircase_pull.h"

#include <utility>

#include <fmt/format.h>

namespace tautline::experiments {
namespace {

const std::vector<double> kQuickPulls{0.3, 0.45, 1.0};  // [N]
const std::vector<double> kPulls{0.25, 0.3,  0.35, 0.4, 0.45, 0.5, 0.6,
                                 0.7,  0.85, 1.0,  1.2, 1.5,  2.0};

const std::vector<double>& pulls(const Setup& setup) { return setup.quick ? kQuickPulls : kPulls; }
/// Of a point.
std::int64_t flightCount(const Setup& setup) { return setup.quick ? 5 : 20; }

std::string trialName(double pull, std::size_t station, std::size_t viewpoint) {
  return fmt::format("{:g} N {} {}", pull, kStationNames[station], kViewpoints[viewpoint].name);
}

CampaignTally tallyOf(const Results& results, double pull, std::size_t station,
                      std::size_t viewpoint) {
  CampaignTally tally;
  addEnds(results.at(trialName(pull, station, viewpoint)), tally);
  return tally;
}

Sheet endsSheet(const Setup& setup, const Results& results) {
  Sheet sheet{"pull_ends", {"<station", "<path", "pull [N]"}, {}};
  for (const auto& end : kFlightEndNames) sheet.columns.emplace_back(end.name);
  forEachStairs([&](std::size_t station, std::size_t v) {
    for (const double pull : pulls(setup)) {
      const CampaignTally tally = tallyOf(results, pull, station, v);
      std::vector<std::string> row{kStationNames[station], kViewpoints[v].name,
                                   fmt::format("{:g}", pull)};
      for (const std::int64_t count : tally.ends) row.push_back(std::to_string(count));
      sheet.rows.push_back(std::move(row));
    }
  });
  return sheet;
}

plot::Figure successFigure(const Setup& setup, const Results& results) {
  plot::Panel panel{.title = "Share of flights that finish",
                    .x = {.label = "pull on the tether [N]", .logarithmic = true},
                    .y = {.label = "share", .limits = plot::Limits{-0.03, 1.05}}};
  forEachStairs([&](std::size_t station, std::size_t v) {
    plot::Series line{.name = fmt::format("{}, {}", kViewpoints[v].name, kStationNames[station]),
                      .points = {},
                      .style = station == 0 ? plot::Style::kLinePoints : plot::Style::kDashed,
                      .colour = kViewpoints[v].colour,
                      .width = 1.6};
    for (const double pull : pulls(setup)) {
      line.points.push_back({pull, tallyOf(results, pull, station, v).finishedShare()});
    }
    panel.series.push_back(std::move(line));
  });
  for (const Viewpoint& view : kViewpoints) {
    const double share = static_cast<double>(view.successes) / kPublishedTrials;
    panel.series.push_back({.name = fmt::format("{}, published", view.name),
                            .points = {{pulls(setup).front(), share}, {pulls(setup).back(), share}},
                            .style = plot::Style::kDotted,
                            .colour = view.colour});
  }
  return {.width_px = 900, .height_px = 520, .panels = {panel}};
}

}  // namespace

std::vector<Trial> stairPullTrials(const Setup& setup,
                                   const std::shared_ptr<const Stairs>& stairs) {
  std::vector<Trial> all;
  forEachStairs([&](std::size_t station, std::size_t v) {
    for (const double pull : pulls(setup)) {
      const StairTrial trial{.seed = setup.seed, .flights = flightCount(setup), .pull = pull};
      all.push_back({trialName(pull, station, v), [stairs, station, v, trial] {
                       return flyStairs(stairs->flights[station][v], trial);
                     }});
    }
  });
  return all;
}

void addStairPulls(const Setup& setup, const Results& results, Findings& findings) {
  findings.sheets.push_back(endsSheet(setup, results));
  findings.pictures.push_back(
      {"pull",
       fmt::format("Share of {} flights that finish, over the pull that the vehicle keeps on its "
                   "tether. Our station is told it; the published correction has no use for it.",
                   flightCount(setup)),
       successFigure(setup, results)});
}

}  // namespace tautline::experiments
