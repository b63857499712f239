/// @file
/// `tautline-bench`: flights of the real station core against the simulated machine, in lock-step.

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/bench/flight_log_replay.h"
#include "app/bench/lockstep.h"
#include "app/bench/log_sink.h"
#include "app/bench/replay.h"
#include "app/bench/safety_command.h"
#include "app/bench/scenario_command.h"
#include "app/experiments/calibrate_command.h"
#include "app/experiments/campaign_command.h"
#include "app/experiments/experiments_command.h"
#include "app/station/recording.h"
#include "app/version.h"
#include "common/clock.h"
#include "common/error.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"
#include "common/toml/config_file.h"

namespace {

using namespace tautline;

struct Options {
  std::string mission;
  std::string scene;
  std::string station_config;
  std::string sim_config;
  std::string log;
  std::uint64_t seed{1};
  double limit_s{900.0};
  double speed{0.0};
  bool json{false};
};

ExitCode fly(const Options& o) {
  const Mission mission = readMission(o.mission);
  bench::LockstepConfig config;
  config.world = sceneInWorld(readScene(o.scene));
  if (!o.station_config.empty()) config.station = loadConfig<StationConfig>(o.station_config);
  if (!o.sim_config.empty()) config.sim = loadConfig<sim::SimConfig>(o.sim_config);
  config.seed = o.seed;
  if (!config.world.start) {
    throw InputError({.file = o.scene,
                      .key = "start_m",
                      .problem = "is missing",
                      .remedy = "say where the drone is parked"});
  }

  const auto sink = o.log.empty() ? nullptr : std::make_unique<bench::LogSink>(o.log);
  bench::Lockstep flight(config, sink.get());
  double error_sum = 0.0;
  std::int64_t cycles = 0;
  const Time began = monotonicNow();
  const bench::FlightResult r = bench::flyMission(
      flight, *mission.plan, fromSeconds(o.limit_s), [&](const bench::Lockstep& b) {
        error_sum += (b.output().estimate.p_WD - b.truth().p_WD).norm();
        ++cycles;
      });
  const double wall_s = toSeconds(monotonicNow() - began);
  const double flight_s = toSeconds(r.duration);
  const double localization_mean = cycles > 0 ? error_sum / static_cast<double>(cycles) : 0.0;
  const char* crash = nameOf(r.crash, sim::kCrashReasonNames);
  const bool success = r.completed && r.landed;
  if (o.json) {
    fmt::print("{}\n", nlohmann::json{{"mission", mission.name},
                                      {"seed", o.seed},
                                      {"armed", r.armed},
                                      {"took_off", r.took_off},
                                      {"mission_completed", r.completed},
                                      {"landed", r.landed},
                                      {"crash", crash},
                                      {"flight_s", flight_s},
                                      {"localization_mean_m", localization_mean},
                                      {"times_real_time", flight_s / wall_s}}
                           .dump());
  } else {
    fmt::print(
        "{} seed {}: {}, {}, {:.1f} s flight, localization error {:.3f} m mean, {:.0f} times real "
        "time{}{}\n",
        mission.name, o.seed, r.completed ? "completed" : "NOT completed",
        r.landed ? "landed" : "NOT landed", flight_s, localization_mean, flight_s / wall_s,
        r.crash == sim::CrashReason::kNone ? "" : ", crash: ",
        r.crash == sim::CrashReason::kNone ? "" : crash);
  }
  return success ? ExitCode::kOk : ExitCode::kFailed;
}

void showSecond(Duration since_start, const Estimate& e) {
  fmt::print("{:7.1f} s  x {:6.2f}  y {:6.2f}  z {:6.2f} m  {}\n", toSeconds(since_start),
             e.p_WD.x(), e.p_WD.y(), e.p_WD.z(), nameOf(e.health, kEstimateHealthNames));
  std::fflush(stdout);
}

ExitCode replayTextLog(const Options& o, Recording recording, const bench::Playback& playback) {
  const StationConfig station =
      o.station_config.empty() ? StationConfig{} : loadConfig<StationConfig>(o.station_config);
  const bench::FlightLogReplay r =
      bench::replayFlightLog(std::move(recording), station.core.localizer, playback);
  if (o.json) {
    fmt::print("{}\n", nlohmann::json{{"rows", r.rows},
                                      {"rows_skipped", r.rows_skipped},
                                      {"rows_with_contact", r.rows_with_contact},
                                      {"reel_samples", r.reel_samples},
                                      {"angle_samples", r.angle_samples},
                                      {"duration_s", r.duration_s},
                                      {"usable", r.usable},
                                      {"distance_mean_m", r.distance_mean_m},
                                      {"distance_max_m", r.distance_max_m}}
                           .dump());
  } else {
    fmt::print(
        "{} rows over {:.0f} s ({} skipped, {} with a contact), {} length and {} angle samples; "
        "usable {:.0f} % of the time; {:.2f} m mean, {:.2f} m at most from the log's own "
        "position\n",
        r.rows, r.duration_s, r.rows_skipped, r.rows_with_contact, r.reel_samples, r.angle_samples,
        100.0 * r.usable, r.distance_mean_m, r.distance_max_m);
  }
  return r.usable > 0.0 ? ExitCode::kOk : ExitCode::kFailed;
}

ExitCode replayLog(const Options& o) {
  bench::Playback playback;
  playback.speed = o.speed;
  if (o.speed > 0.0 && !o.json) playback.each_second = showSecond;
  if (!isLcmLog(o.log)) return replayTextLog(o, readRecording(o.log), playback);
  const bench::ReplayResult r = bench::replay(o.log, playback);
  const bool same = r.differences == 0 && r.commands_compared > 0;
  if (o.json) {
    fmt::print("{}\n", nlohmann::json{{"cycles", r.cycles},
                                      {"commands_compared", r.commands_compared},
                                      {"differences", r.differences},
                                      {"first_difference", r.first_difference},
                                      {"damage", r.damage}}
                           .dump());
  } else {
    fmt::print("{} cycles replayed, {} commands compared, {} differ{}{}\n", r.cycles,
               r.commands_compared, r.differences, r.differences == 0 ? "" : ": first ",
               r.first_difference);
    if (!r.damage.empty()) fmt::print("the log is {}\n", r.damage);
  }
  return same ? ExitCode::kOk : ExitCode::kFailed;
}

void addFly(CLI::App& app, Options& options, ExitCode& result) {
  CLI::App* verb = app.add_subcommand(
      "fly", "Fly one mission; exit code 0 only if it was completed and the drone landed");
  verb->add_option("--mission", options.mission, "mission file")->required();
  verb->add_option("--scene", options.scene, "scene file")->required();
  verb->add_option("--seed", options.seed,
                   "of gusts, sensor noise and, with [dispersion], of the machine")
      ->capture_default_str();
  verb->add_option("--station-config", options.station_config, "station's TOML file");
  verb->add_option("--sim-config", options.sim_config, "simulator's TOML file");
  verb->add_option("--log", options.log, "write an LCM log for `tautline report`");
  verb->add_option("--limit", options.limit_s, "give up after this much flight time [s]")
      ->capture_default_str();
  verb->add_flag("--json", options.json, "one JSON object instead of words");
  verb->footer(
      "Example: tautline-bench fly --mission config/missions/square.mission.toml --scene "
      "config/scenes/open.scene.toml --log "
      "flight.lcm");
  verb->callback([&] { result = fly(options); });
}

void addReplay(CLI::App& app, Options& options, ExitCode& result) {
  CLI::App* verb = app.add_subcommand(
      "replay",
      "Step a recorded flight again; exit code 0 only if every command is the same. A text log of "
      "the published flights goes through the estimator");
  verb->add_option("log", options.log, "LCM log, or text log of the published flights")->required();
  verb->add_option("--speed", options.speed,
                   "times real time, with a line for each second; 0: as fast as it goes")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--station-config", options.station_config,
                   "station's TOML file, for text logs: its localizer");
  verb->add_flag("--json", options.json, "one JSON object instead of words");
  verb->footer("Example: tautline-bench replay flight.lcm --speed 2");
  verb->callback([&] { result = replayLog(options); });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Tautline's lock-step bench: station core and simulated machine on one virtual clock",
      "tautline-bench"};
  app.require_subcommand(1);
  app.set_version_flag("--version", kVersion);
  Options options;
  ExitCode result = ExitCode::kOk;
  addFly(app, options, result);
  addReplay(app, options, result);
  bench::addScenarioCommand(app, result);
  bench::addSafetyCommand(app, result);
  experiments::addExperimentsCommand(app, result);
  experiments::addCampaignCommand(app, result);
  experiments::addCalibrateCommand(app, result);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::kUsage);
  } catch (...) {
    return reportException("tautline-bench");
  }
  return static_cast<int>(result);
}
