#include "app/experiments/staircase.h"

#include <algorithm>
#include <array>
#include <memory>

#include <fmt/format.h>

#include "app/experiments/flight_campaign.h"
#include "app/experiments/map_world.h"
#include "app/experiments/planned_path.h"
#include "common/plot/views.h"

namespace tautline::experiments {
namespace {

/// The vehicle's radius in plant.toml: the planner's map is grown by it.
constexpr double kInflation = 0.15;  // [m]

struct Viewpoint {
  const char* name;
  Eigen::Vector3d goal;  // M [m]
  double reward;
  // Published, chapter 7: risk, utility, and successes of ten trials.
  double risk;
  double utility;
  int successes;
  double wanted;  // of our success
  plot::Colour colour;
};
const std::array kViewpoints{
    Viewpoint{"red", {5.0, 0.6, 4.2}, 1.0, 0.714, 1.401, 2, 0.85, plot::Colour::kVermilion},
    Viewpoint{"green", {3.8, 2.6, 1.4}, 0.9, 0.575, 1.565, 4, 0.95, plot::Colour::kGreen}};
constexpr int kPublishedTrials = 10;
constexpr std::array kStations{"as published", "ours"};

constexpr std::int64_t kQuickFlights = 20;
constexpr std::int64_t kWholeFlights = 10000;
constexpr std::int64_t kFlightsATrial = 20;  // of one trial: what an interrupted run loses

struct Ready {
  planning::RiskSpace space;
  std::array<PlannedPath, kViewpoints.size()> paths;
};

Ready plan(const Setup& setup) {
  const auto config = setup.folder / "..";
  planning::RiskArguments arguments;
  arguments.map.map = (config / "scenes/dissertation/staircase.scene.toml").string();
  arguments.params = (config / "risk/dissertation.toml").string();
  Ready ready{planning::loadRiskSpace(arguments, planning::Progress{}), {}};
  for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
    ready.paths[v] =
        planPath(ready.space, "directional", *ready.space.space.map->start, kViewpoints[v].goal);
    TAUTLINE_CHECK(ready.paths[v].found());
  }
  return ready;
}

CampaignFlight flightOf(const Setup& setup, const Ready& ready, std::size_t viewpoint,
                        std::size_t station) {
  CampaignFlight flight;
  flight.station = station == 0 ? publishedDemonstration(setup) : setup.tautline;
  flight.plant = setup.plant;
  flight.mission = &ready.paths[viewpoint].mission;
  const planning::VoxelMap& map = *ready.space.space.map;
  flight.world = worldOf(map, *map.reel, *flight.mission->plan, kInflation);
  return flight;
}

std::int64_t flightsOf(const Setup& setup) { return setup.quick ? kQuickFlights : kWholeFlights; }

std::string trialName(std::size_t station, std::size_t viewpoint, std::int64_t first) {
  return fmt::format("{} {} {}", kStations[station], kViewpoints[viewpoint].name, first);
}

nlohmann::json flyTrial(const CampaignFlight& flight, std::uint64_t seed, std::int64_t count,
                        bool with_track) {
  nlohmann::json result = {{"ends", nlohmann::json::array()}};
  for (std::int64_t i = 0; i < count; ++i) {
    FlightTrack track;
    const FlightVerdict verdict =
        flyPlanned(flight.config(seed + static_cast<std::uint64_t>(i)), *flight.mission->plan,
                   flight.goal_tolerance, with_track ? &track : nullptr);
    result["ends"].push_back(toJson(verdict));
    if (!with_track) continue;
    nlohmann::json points = nlohmann::json::array();
    for (std::size_t k = 0; k < track.size(); k += 5)
      points.push_back({track[k].x(), track[k].y(), track[k].z()});
    result["tracks"].push_back(std::move(points));
  }
  return result;
}

template <class Visit>
void forEachTrial(const Setup& setup, Visit visit) {
  for (std::size_t station = 0; station < kStations.size(); ++station) {
    for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
      for (std::int64_t first = 0; first < flightsOf(setup); first += kFlightsATrial)
        visit(station, v, first, std::min(kFlightsATrial, flightsOf(setup) - first));
    }
  }
}

std::vector<Trial> trials(const Setup& setup) {
  const auto ready = std::make_shared<const Ready>(plan(setup));
  std::array<std::array<std::shared_ptr<const CampaignFlight>, 2>, 2> flights;
  for (std::size_t station = 0; station < kStations.size(); ++station) {
    for (std::size_t v = 0; v < kViewpoints.size(); ++v)
      flights[station][v] =
          std::make_shared<const CampaignFlight>(flightOf(setup, *ready, v, station));
  }
  std::vector<Trial> all;
  forEachTrial(
      setup, [&](std::size_t station, std::size_t v, std::int64_t first, std::int64_t count) {
        all.push_back({trialName(station, v, first),
                       [ready, flight = flights[station][v], first, count, seed = setup.seed] {
                         return flyTrial(*flight, seed + static_cast<std::uint64_t>(first), count,
                                         first == 0);
                       }});
      });
  return all;
}

/// Places are sorted by state of the path: where most flights end is where to look.
Sheet endsSheet(const std::array<std::array<CampaignTally, 2>, 2>& tallies) {
  Sheet sheet{"ends", {"<station", "<path", "<end", "waypoint", "flights"}, {}};
  for (std::size_t station = 0; station < kStations.size(); ++station) {
    for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
      std::map<std::pair<std::string, int>, int> counts;
      for (const FlightVerdict& verdict : tallies[station][v].verdicts) {
        std::string end = nameOf(verdict.end, kFlightEndNames);
        if (verdict.end == FlightEnd::kAborted) end += " (" + verdict.why + ")";
        ++counts[{end, verdict.waypoint}];
      }
      for (const auto& [what, count] : counts)
        sheet.rows.push_back({kStations[station], kViewpoints[v].name, what.first,
                              std::to_string(what.second), std::to_string(count)});
    }
  }
  return sheet;
}

Sheet successSheet(const std::array<std::array<CampaignTally, 2>, 2>& tallies) {
  Sheet sheet{
      "success", {"<station", "<path", "flights", "finished", "success", "95 % from", "to"}, {}};
  for (std::size_t station = 0; station < kStations.size(); ++station) {
    for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
      const CampaignTally& t = tallies[station][v];
      const std::int64_t finished = t.flights() - t.failed();
      const Interval i = clopperPearson(finished, t.flights());
      sheet.rows.push_back(
          {kStations[station], kViewpoints[v].name, std::to_string(t.flights()),
           std::to_string(finished),
           fmt::format("{:.4f}", static_cast<double>(finished) / static_cast<double>(t.flights())),
           fmt::format("{:.4f}", i.low), fmt::format("{:.4f}", i.high)});
    }
  }
  return sheet;
}

Picture flightsPicture(const Setup& setup, const Ready& ready, const Results& results,
                       std::size_t station) {
  plot::Drawing drawing;
  drawing.title = fmt::format("Staircase, {}: planned and flown", kStations[station]);
  plot::addScene(drawing, flightOf(setup, ready, 0, station).world);
  for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
    plot::SpaceCurve planned{.name = fmt::format("{}, planned", kViewpoints[v].name),
                             .points = {},
                             .style = plot::Style::kLinePoints,
                             .colour = kViewpoints[v].colour,
                             .width = 2.0};
    for (const Eigen::Vector3d& p : ready.paths[v].points)
      planned.points.push_back(p - *ready.space.space.map->reel);
    drawing.curves.push_back(std::move(planned));
    const nlohmann::json& trial = results.at(trialName(station, v, 0));
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

Findings judge(const Setup& setup, const Results& results) {
  const Ready ready = plan(setup);
  std::array<std::array<CampaignTally, 2>, 2> tallies;
  forEachTrial(setup,
               [&](std::size_t station, std::size_t v, std::int64_t first, std::int64_t /*count*/) {
                 for (const auto& end : results.at(trialName(station, v, first)).at("ends"))
                   tallies[station][v].add(verdictFrom(end));
               });
  Findings findings;
  for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
    const Viewpoint& view = kViewpoints[v];
    const double risk = ready.paths[v].prediction.risk;
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
    const Interval published = clopperPearson(view.successes, kPublishedTrials);
    std::array<double, 2> success{};
    for (std::size_t s = 0; s < kStations.size(); ++s) {
      const CampaignTally& t = tallies[s][v];
      success[s] = 1.0 - static_cast<double>(t.failed()) / static_cast<double>(t.flights());
    }
    const Band trials_band{published.low, published.high};
    const bool only_published_misses = !trials_band.has(success[0]) && success[1] >= view.wanted;
    findings.rows.push_back(
        {.figure = fmt::format("{}: share of flights that finish", view.name),
         .published = static_cast<double>(view.successes) / kPublishedTrials,
         .as_published = success[0],
         .tautline = success[1],
         .as_published_band = trials_band,
         .tautline_band = Band{.min = view.wanted},
         .note = fmt::format("{} flights each; the band of the published software is the exact 95 "
                             "% interval of its ten trials.",
                             flightsOf(setup)),
         .shortfall = only_published_misses
                          ? "the published error is a bias, the same in every flight of this "
                            "plant, so nearly all of them end alike; the trials had more chance "
                            "in them"
                          : ""});
  }
  findings.sheets.push_back(successSheet(tallies));
  findings.sheets.push_back(endsSheet(tallies));
  for (std::size_t station = 0; station < kStations.size(); ++station)
    findings.pictures.push_back(flightsPicture(setup, ready, results, station));
  return findings;
}

}  // namespace

StationConfig publishedDemonstration(const Setup& setup) {
  StationConfig station = setup.as_published;
  station.core.localizer.variant = LocalizerVariant::kAsPublishedCode;
  station.core.control.law = Law::kPosition;
  return station;
}

const Experiment kStaircase{
    "staircase", "Staircase: both viewpoints",
    "The paths of least risk to both viewpoints of the staircase, planned by our planner in the "
    "dissertation's voxels, each flown many times. The voxels are the real things grown by the "
    "vehicle's radius (0.15 m), so the plant's solids are thinner by that on each side. A flight "
    "is "
    "finished if its mission is flown without touching anything and the drone truly ends within "
    "0.7 "
    "m of the viewpoint.",
    trials, judge};

}  // namespace tautline::experiments
