#include "app/experiments/calibrate_command.h"

#include <memory>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/bench/batch.h"
#include "app/experiments/calibration.h"
#include "common/toml/config_file.h"
#include "common/toml/toml_file.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/cli/workspace.h"

namespace tautline::experiments {
namespace {

struct Options {
  TruthOptions truth;
  std::string params{"config/risk/dissertation.toml"};
  std::string output;
  std::string station_config;
  std::string sim_config;
  std::string folder;
  int jobs{0};
  bool json{false};
};

std::vector<TruthPath> fly(const Options& o, const planning::RiskParams& params,
                           const CampaignFlight& who) {
  const std::vector<TruthCase> cases = truthCases(o.truth);
  const std::string fingerprint =
      hashText(fnv1a(readTextFile("/proc/self/exe") + dumpConfig(params) + dumpConfig(who.station) +
                     dumpConfig(who.plant) +
                     fmt::format("{} {} {}", o.truth.seed, o.truth.goals, o.truth.flights)));
  bench::Batch batch;
  for (const TruthCase& c : cases) batch.keys.push_back(fingerprint + " " + c.name());
  batch.workers = o.jobs;
  batch.folder = o.folder;
  batch.what = "paths";
  batch.run = [&](std::size_t i) {
    return toJson(flyTruthCase(cases[i], o.truth, params, who)).dump();
  };
  std::vector<TruthPath> paths;
  const bench::BatchResult result = bench::runBatch(batch);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const bench::JobOutcome& outcome = result.outcomes[i];
    if (!outcome.failure.empty()) {
      throw InputError(
          {.key = cases[i].name(), .problem = "could not be flown: " + outcome.failure},
          ExitCode::kFailed);
    }
    paths.push_back(truthPathFrom(nlohmann::json::parse(outcome.line)));
  }
  return paths;
}

std::vector<Forecast> forecastsOf(const std::vector<TruthPath>& paths) {
  std::vector<Forecast> forecasts;
  for (const TruthPath& p : paths) forecasts.push_back(p.forecast(p.prediction.risk));
  return forecasts;
}

nlohmann::json scoreJson(const std::vector<Forecast>& forecasts) {
  return {{"brier", brierScore(forecasts)}, {"calibration_error", calibrationError(forecasts)}};
}

/// Scores on the rooms that the fit has not seen, and what was found.
nlohmann::json resultJson(const Options& o, const CalibratedRisk& found, const Halves& halves) {
  const std::array<Measure, kMeasures> measures = measure(halves.even, halves.odd);
  nlohmann::json json = {
      {"seed", o.truth.seed},
      {"paths_fitted", halves.even.size()},
      {"paths_judged", halves.odd.size()},
      {"rounds", found.rounds},
      {"before", scoreJson(measures[kIndex].forecasts)},
      {"after", scoreJson(forecastsOf(reassess(halves.odd, o.truth.seed, found.params)))},
      {"additive", scoreJson(measures[kAdditive].forecasts)},
      {"additive_fitted", scoreJson(measures[kAdditiveScaled].forecasts)},
      {"base_rate", scoreJson(measures[kBaseRate].forecasts)}};
  for (const planning::RiskElement e : elementsOf(halves.even))
    json["factors"][nameOf(e, planning::kRiskElementNames)] =
        found.factors[static_cast<std::size_t>(e)];
  return json;
}

void print(const Options& o, const nlohmann::json& r) {
  fmt::print("fitted on {} paths, judged on {} paths of other rooms\n",
             r.at("paths_fitted").get<int>(), r.at("paths_judged").get<int>());
  for (const auto& [element, factor] : r.at("factors").items())
    fmt::print("  {:<16} x {:.3f}\n", element, factor.get<double>());
  const auto line = [&](const char* name, const char* key) {
    fmt::print("{:<28} Brier {:.4f}, calibration error {:.4f}\n", name,
               r.at(key).at("brier").get<double>(),
               r.at(key).at("calibration_error").get<double>());
  };
  line("before", "before");
  line("after", "after");
  line("additive measure", "additive");
  line("additive, one fitted factor", "additive_fitted");
  line("share of failures alone", "base_rate");
  fmt::print("written: {}\n", o.output);
}

ExitCode run(const Options& o) {
  const auto params = loadConfig<planning::RiskParams>(o.params);
  CampaignFlight who;
  if (!o.station_config.empty()) who.station = loadConfig<StationConfig>(o.station_config);
  if (!o.sim_config.empty()) who.plant = loadConfig<sim::SimConfig>(o.sim_config);
  const Halves halves = halve(fly(o, params, who));
  if (!canFit(halves.even) || halves.odd.empty()) {
    throw InputError({.key = "flights",
                      .problem = "of the rooms to fit on all ended alike, so that they say nothing "
                                 "about what the risk depends on",
                      .remedy = "more --maps or --flights, or another --station-config"},
                     ExitCode::kFailed);
  }
  const CalibratedRisk found = calibrate(halves.even, o.truth.seed, params);
  writeFileAtomically(o.output, dumpConfig(found.params));
  const nlohmann::json result = resultJson(o, found, halves);
  if (o.json) {
    fmt::print("{}\n", result.dump());
  } else {
    print(o, result);
  }
  return ExitCode::kOk;
}

}  // namespace

void addCalibrateCommand(CLI::App& app, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  TruthOptions& truth = options->truth;
  CLI::App* verb = app.add_subcommand(
      "calibrate",
      "Fit the risk model's elements to flights through generated rooms, and judge it on others");
  verb->add_option("-o,--output", options->output, "Write the fitted risk parameters")
      ->required()
      ->type_name("FILE.toml");
  verb->add_option("--params", options->params, "Risk parameters to begin with, and to plan by")
      ->capture_default_str();
  verb->add_option("--maps", truth.maps, "Rooms: every other one is fitted on, the rest judge")
      ->check(CLI::Range(2, 10'000))
      ->capture_default_str();
  verb->add_option("--goals", truth.goals, "In each room, for each of two planners")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--flights", truth.flights, "Of each path")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  verb->add_option("--seed", truth.seed, "Of rooms, goals and flights")->capture_default_str();
  verb->add_option("--station-config", options->station_config, "Station's TOML file");
  verb->add_option("--sim-config", options->sim_config, "Simulator's TOML file");
  verb->add_option("--out", options->folder,
                   "Keep what is flown in this folder, and do not fly again what is there");
  verb->add_option("--jobs", options->jobs, "Processes; 0: one for each processor")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  verb->add_flag("--json", options->json, "One JSON object instead of words");
  verb->footer(
      "Example: tautline-bench calibrate --station-config config/experiments/as_published.toml "
      "--sim-config config/experiments/plant.toml --out build/calibrate -o fitted.toml");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace tautline::experiments
