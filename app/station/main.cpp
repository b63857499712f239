/// @file
/// `tautline-station`: the real-time process. Start-up may fail and says why; after it, the loop of
/// realTimeLoop() runs until SIGTERM or SIGINT.

#include <csignal>
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "app/station/black_box.h"
#include "app/station/fence_scene.h"
#include "app/station/lcm_link.h"
#include "app/station/real_time_loop.h"
#include "app/station/service_notifier.h"
#include "app/station/station.h"
#include "app/station/station_config.h"
#include "app/station/station_device.h"
#include "app/station/telemetry.h"
#include "app/version.h"
#include "common/clock.h"
#include "common/error.h"
#include "common/mission/scene.h"
#include "common/realtime.h"
#include "common/toml/config_file.h"
#include "lcmtypes/channels.h"

namespace {

using namespace tautline;

volatile std::sig_atomic_t stop_requested = 0;

void onSignal(int) { stop_requested = 1; }

struct Options {
  std::string config_file;
  std::string device;
  std::string scene_file;
  std::string lcm_url{kDefaultLcmUrl};
  bool check_config{false};
  bool print_config{false};
};

void addOptions(CLI::App& app, Options& o) {
  app.add_option("--config", o.config_file, "station's TOML file; without it, all defaults");
  app.add_option("--device", o.device,
                 "where the device is, instead of the file's: serial.device, can.interface or "
                 "replay.file");
  app.add_option("--scene", o.scene_file,
                 "scene file: its start is home, instead of core.guidance.home_position_m, and its "
                 "obstacles are those of core.fence");
  app.add_option("--lcm-url", o.lcm_url, "where the other programs are")->capture_default_str();
  app.add_flag("--check-config", o.check_config,
               "read everything, say whether it is right, and end");
  app.add_flag("--print-config", o.print_config,
               "print the effective configuration as TOML, and end");
  app.set_version_flag("--version", kVersion);
  app.footer("Example: tautline-station --config config/station.toml --device /dev/ttyACM0");
}

StationConfig effectiveConfig(const Options& o) {
  StationConfig config =
      o.config_file.empty() ? StationConfig{} : loadConfig<StationConfig>(o.config_file);
  if (!o.device.empty()) placeOf(config) = o.device;
  if (!o.scene_file.empty()) {
    const Scene scene = sceneInWorld(readScene(o.scene_file));
    if (!scene.start) {
      throw InputError({.file = o.scene_file,
                        .key = "start_m",
                        .problem = "is missing",
                        .remedy = "say where the drone is parked"});
    }
    config.core.guidance.home_position_m = *scene.start;
    config.core.fence.obstacles = fenceObstaclesOf(scene);
  }
  return config;
}

/// Real-time rights by the config's policy; says what is missing. True if the loop has a real-time
/// priority and all else that was asked for.
bool becomeRealTime(const StationConfig& config) {
  bool complete = config.realtime_priority > 0;
  for (const RealTimeStep& step : startRealTime({config.realtime_priority, config.realtime_cpu})) {
    if (step.ok) continue;
    complete = false;
    if (config.realtime_policy == RealTimePolicy::kEnforce) {
      throw InputError(
          {.key = "realtime_policy", .problem = "not " + step.name + ": " + step.reason},
          ExitCode::kFailed);
    }
    fmt::print(stderr, "tautline-station: warning: not {}: {}\n", step.name, step.reason);
  }
  return complete;
}

/// A box that cannot be made is no reason to stay on the ground; one that another station has is.
std::unique_ptr<BlackBox> makeBlackBox(const StationConfig& config) {
  if (config.black_box.empty()) return nullptr;
  try {
    return std::make_unique<BlackBox>(config.black_box);
  } catch (const InputError& e) {
    if (e.code() == ExitCode::kRefused) throw;
    fmt::print(stderr, "tautline-station: warning: {}; there is no black box\n", e.what());
    return nullptr;
  }
}

void run(const Options& options) {
  const StationConfig config = effectiveConfig(options);
  const std::string effective = dumpConfig(config);
  if (options.print_config) {
    fmt::print("{}", effective);
    return;
  }
  if (options.check_config) {
    fmt::print("configuration is right\n");
    return;
  }

  LcmLink lcm(options.lcm_url, config.core.authority);
  const StationDevice made = makeDevice(config);
  Device& device = *made.device;
  if (!made.warning.empty())
    fmt::print(stderr, "tautline-station: warning: {}; trying again\n", made.warning);
  const auto station = std::make_unique<Station>(config.core);
  const std::unique_ptr<BlackBox> black_box = makeBlackBox(config);
  Telemetry telemetry(lcm, config.run_mode, unixOffset(),
                      fromSeconds(1.0 / config.telemetry_rate_hz));

  telemetry.setParams("tautline-station", kVersion, effective);
  telemetry.setPlace(made.place);

  ServiceNotifier service(serviceManagerFromEnvironment());
  if (!service.error().empty())
    fmt::print(stderr, "tautline-station: warning: {}; its watchdog hears nothing\n",
               service.error());

  HostFacts host;
  host.run_mode = config.run_mode;
  host.real_time = becomeRealTime(config);
  fmt::print("tautline-station {}: {} on {}, {:g} Hz, {}; stop with Ctrl-C\n", kVersion,
             device.name(), made.place, config.loop_rate_hz,
             nameOf(config.run_mode, kRunModeNames));
  std::fflush(stdout);

  const LoopParts parts{device, lcm, *station, telemetry, black_box.get(), &service, host, &made};
  const LoopStatistics::Snapshot summary =
      realTimeLoop(parts, fromSeconds(1.0 / config.loop_rate_hz), stop_requested);
  fmt::print("tautline-station: stopped after {} cycles, {} overruns, {} periods skipped\n",
             summary.cycles, summary.overruns, summary.skipped_periods);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Tautline's station: flies a tethered drone through its serial or CAN device, talks LCM",
      "tautline-station"};
  Options options;
  addOptions(app, options);
  std::signal(SIGTERM, onSignal);
  std::signal(SIGINT, onSignal);
  std::signal(SIGHUP, onSignal);
  try {
    app.parse(argc, argv);
    run(options);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::kUsage);
  } catch (...) {
    return reportException("tautline-station");
  }
  return 0;
}
