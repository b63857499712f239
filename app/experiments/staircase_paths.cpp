#include "app/experiments/staircase_paths.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/experiments/binomial.h"
#include "app/experiments/map_world.h"
#include "common/error.h"

namespace tautline::experiments {
namespace {

constexpr std::int64_t kFlightsATrial = 20;  // what an interrupted run loses

template <class Visit>
void forEachTrial(std::int64_t flights, Visit visit) {
  forEachStairs([&](std::size_t station, std::size_t v) {
    for (std::int64_t first = 0; first < flights; first += kFlightsATrial) visit(station, v, first);
  });
}

}  // namespace

std::shared_ptr<const Stairs> planStairs(const Setup& setup) {
  const auto config = setup.folder / "..";
  planning::RiskArguments arguments;
  arguments.map.map = (config / "scenes/dissertation/staircase.scene.toml").string();
  arguments.params = (config / "risk/dissertation.toml").string();
  const auto stairs = std::make_shared<Stairs>();
  stairs->space = planning::loadRiskSpace(arguments, planning::Progress{});
  const planning::VoxelMap& map = *stairs->space.space.map;
  const double radius = setup.plant.vehicle.radius;  // the planner's map is grown by it
  for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
    PlannedPath& path = stairs->paths[v];
    path = planPath(stairs->space, "directional", *map.start, kViewpoints[v].goal);
    TAUTLINE_CHECK(path.found());
    for (std::size_t station = 0; station < kStationNames.size(); ++station) {
      CampaignFlight& flight = stairs->flights[station][v];
      flight.station = demonstrationStation(setup, station);
      flight.plant = setup.plant;
      flight.mission = &path.mission;
      flight.world = worldOf(map, *map.reel, *path.mission.plan, radius);
    }
  }
  return stairs;
}

nlohmann::json flyStairs(const CampaignFlight& flight, const StairTrial& trial) {
  nlohmann::json result = {{"ends", nlohmann::json::array()}};
  for (std::int64_t i = 0; i < trial.flights; ++i) {
    bench::LockstepConfig config = flight.config(trial.seed + static_cast<std::uint64_t>(i));
    if (trial.pull) pullWith(config, *trial.pull);
    FlightTrack track;
    result["ends"].push_back(toJson(flyPlanned(config, *flight.mission->plan, flight.goal_tolerance,
                                               trial.tracks ? &track : nullptr)));
    if (!trial.tracks) continue;
    nlohmann::json points = nlohmann::json::array();
    for (std::size_t k = 0; k < track.size(); k += 5)
      points.push_back({track[k].x(), track[k].y(), track[k].z()});
    result["tracks"].push_back(std::move(points));
  }
  return result;
}

void addEnds(const nlohmann::json& result, CampaignTally& tally) {
  for (const auto& end : result.at("ends")) tally.add(verdictFrom(end));
}

std::string stairTrialName(std::size_t station, std::size_t viewpoint, std::int64_t first) {
  return fmt::format("{} {} {}", kStationNames[station], kViewpoints[viewpoint].name, first);
}

std::vector<Trial> stairTrials(const Setup& setup, const std::shared_ptr<const Stairs>& stairs,
                               std::int64_t flights) {
  std::vector<Trial> all;
  forEachTrial(flights, [&](std::size_t station, std::size_t v, std::int64_t first) {
    const StairTrial trial{.seed = setup.seed + static_cast<std::uint64_t>(first),
                           .flights = std::min(kFlightsATrial, flights - first),
                           .tracks = first == 0};
    all.push_back({stairTrialName(station, v, first), [stairs, station, v, trial] {
                     return flyStairs(stairs->flights[station][v], trial);
                   }});
  });
  return all;
}

StairTallies stairTallies(const Results& results, std::int64_t flights) {
  StairTallies tallies;
  forEachTrial(flights, [&](std::size_t station, std::size_t v, std::int64_t first) {
    addEnds(results.at(stairTrialName(station, v, first)), tallies[station][v]);
  });
  return tallies;
}

Row successRow(const Viewpoint& view, const CampaignTally& as_published,
               const CampaignTally& ours) {
  const Interval published = clopperPearson(view.successes, kPublishedTrials);
  return {.figure = fmt::format("{}: share of flights that finish", view.name),
          .published = static_cast<double>(view.successes) / kPublishedTrials,
          .as_published = as_published.finishedShare(),
          .tautline = ours.finishedShare(),
          .as_published_band = Band{published.low, published.high},
          .note = fmt::format("{} flights each; the band of the published software is the exact 95 "
                              "% interval of its ten trials.",
                              ours.flights())};
}

}  // namespace tautline::experiments
