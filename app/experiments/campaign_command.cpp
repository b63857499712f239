#include "app/experiments/campaign_command.h"

#include <filesystem>
#include <memory>
#include <string>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/experiments/flight_campaign.h"
#include "app/experiments/map_world.h"
#include "app/experiments/planned_path.h"
#include "common/toml/config_file.h"
#include "common/toml/toml_writer.h"

namespace tautline::experiments {
namespace {

struct Options {
  planning::RiskArguments risk;
  std::string mission;
  std::string station_config;
  std::string sim_config;
  std::string shard{"1/1"};
  std::string write_scene;
  CampaignOptions campaign{.flights = 100, .shard = {}, .folder = {}};
  double inflation{0.0};
  double goal_tolerance{kGoalTolerance};
  bool json{false};
};

nlohmann::json tallyJson(const CampaignTally& tally) {
  nlohmann::json by_kind = nlohmann::json::object();
  for (const auto& end : kFlightEndNames) {
    if (end.value != FlightEnd::kFinished)
      by_kind[end.name] = tally.ends[static_cast<std::size_t>(end.value)];
  }
  const Interval interval = tally.interval();
  const std::int64_t n = tally.flights();
  nlohmann::json json = {{"flights", n},
                         {"failed", tally.failed()},
                         {"failures_by_kind", by_kind},
                         {"failure_interval_95", {interval.low, interval.high}},
                         {"interval", "Clopper-Pearson"}};
  json["failure_rate"] =
      n > 0 ? nlohmann::json(static_cast<double>(tally.failed()) / static_cast<double>(n))
            : nlohmann::json(nullptr);
  return json;
}

void printTally(const Options& o, const Prediction& predicted, const CampaignTally& tally) {
  fmt::print("predicted: risk {:.3f}; the additive measure says {:.3f}\n", predicted.risk,
             predicted.additive);
  const Interval i = tally.interval();
  fmt::print("flown: {} of {} flights failed, {:.3f} to {:.3f} (95 %, Clopper-Pearson)\n",
             tally.failed(), tally.flights(), i.low, i.high);
  for (const auto& end : kFlightEndNames) {
    const std::int64_t count = tally.ends[static_cast<std::size_t>(end.value)];
    if (count > 0) fmt::print("  {:<13} {}\n", end.name, count);
  }
  if (tally.known > 0) fmt::print("{} were flown before ({})\n", tally.known, o.campaign.folder);
}

ExitCode run(Options& o) {
  o.campaign.shard = bench::parseShard(o.shard);
  planning::needFinite("--inflation", o.inflation);
  planning::needFinite("--goal-tolerance", o.goal_tolerance);
  const Mission mission = readMission(o.mission);
  const Eigen::Vector3d& reel = mission.reel_position;
  planning::RiskArguments risk = o.risk;
  // Scenes have a reel of their own, and the mission's must be the same; other maps have none.
  const bool scene = std::filesystem::path(risk.map.map).extension() == ".toml";
  if (risk.map.reel.empty() && !scene)
    risk.map.reel = fmt::format("{},{},{}", reel.x(), reel.y(), reel.z());
  const planning::RiskSpace space = planning::loadRiskSpace(risk, planning::Progress{});
  const Prediction predicted = predictMission(space, o.mission);

  CampaignFlight flight;
  flight.mission = &mission;
  flight.goal_tolerance = o.goal_tolerance;
  if (!o.station_config.empty()) flight.station = loadConfig<StationConfig>(o.station_config);
  if (!o.sim_config.empty()) flight.plant = loadConfig<sim::SimConfig>(o.sim_config);
  flight.world = worldOf(*space.space.map, reel, *mission.plan, o.inflation);
  if (!o.write_scene.empty()) {
    writeFileAtomically(o.write_scene, sceneText(sceneFromWorld(flight.world, reel)));
  }
  const CampaignTally tally = flyFlights(flight, o.campaign);
  if (!o.json) {
    printTally(o, predicted, tally);
    return ExitCode::kOk;
  }
  nlohmann::json json = tallyJson(tally);
  json["mission"] = mission.name;
  json["seed"] = o.campaign.seed;
  json["predicted_risk"] = predicted.risk;
  json["additive"] = predicted.additive;
  json["additive_risk"] = predicted.additiveRisk();
  json["map_known_to_station"] = flight.mapKnown();
  fmt::print("{}\n", json.dump());
  return ExitCode::kOk;
}

}  // namespace

void addCampaignCommand(CLI::App& app, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CampaignOptions& c = options->campaign;
  CLI::App* verb = app.add_subcommand(
      "campaign",
      "Fly a planned mission many times and compare the failures with the predicted risk");
  options->risk.addTo(*verb);
  verb->add_option("--mission", options->mission, "Mission file, planned in that map")
      ->required()
      ->type_name("FILE");
  verb->add_option("--flights", c.flights, "How many")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{100'000'000}))
      ->capture_default_str();
  verb->add_option("--seed", c.seed, "Of the first flight; the others' follow")
      ->capture_default_str();
  verb->add_option("--inflation", options->inflation,
                   "The map's obstacles and its border are grown by this much [m]: what is flown "
                   "round is that much thinner on each side, the room that much wider")
      ->capture_default_str();
  verb->add_option("--goal-tolerance", options->goal_tolerance,
                   "A finished flight truly ends this near the last waypoint [m]")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  verb->add_option("--station-config", options->station_config, "Station's TOML file");
  verb->add_option("--sim-config", options->sim_config, "Simulator's TOML file");
  verb->add_option("--shard", options->shard, "I/N: the I-th of N equal parts of the flights")
      ->capture_default_str();
  verb->add_option("--out", c.folder,
                   "Keep what is flown in this folder, and do not fly again what is there");
  verb->add_option("--jobs", c.workers, "Processes; 0: one for each processor")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  verb->add_option("--write-scene", options->write_scene,
                   "Write the world that is flown in, with the parked drone")
      ->type_name("FILE.scene.toml");
  verb->add_flag("--json", options->json, "One JSON object instead of words");
  verb->footer(
      "Example: tautline-bench campaign --map config/scenes/one_contact.scene.toml --resolution "
      "0.2 --mission config/missions/one_contact.mission.toml --flights 100 --seed 1");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace tautline::experiments
