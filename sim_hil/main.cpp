/// @file
/// `tautline-sim`: the simulated drone, reel and tether behind the real device's wire protocol.

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <string>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "common/error.h"
#include "common/mission/scene.h"
#include "common/toml/config_file.h"
#include "lcmtypes/channels.h"
#include "sim_hil/pty_link.h"
#include "sim_hil/real_time_server.h"
#include "sim_hil/sim_config.h"
#include "sim_hil/simulator.h"
#include "sim_hil/truth_publisher.h"

namespace tautline::sim {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void onSignal(int /*signal*/) { stop_requested = 1; }

struct Options {
  std::string pty;
  std::string scene;
  std::string config;
  std::uint64_t seed{1};
  double rate_hz{0.0};
  double duration_s{0.0};
  std::string lcm_url{kDefaultLcmUrl};
  bool no_lcm{false};
  bool check_config{false};
  bool print_config{false};
};

void addOptions(CLI::App& app, Options& o) {
  app.set_version_flag("--version", TAUTLINE_VERSION);
  app.add_option("--pty", o.pty,
                 "make this a link to the device's terminal, e.g. /tmp/tautline-fotokite");
  app.add_option("--scene", o.scene,
                 "*.scene.toml: room, obstacles, reel, start (default: an open floor)");
  app.add_option("--config", o.config, "properties of the machine, see config/sim.toml");
  app.add_option("--seed", o.seed, "of gusts and sensor noise")->capture_default_str();
  app.add_option("--rate-hz", o.rate_hz, "telemetry rate, whatever the client asks for")
      ->check(CLI::Range(0.1, 500.0));
  app.add_option("--duration", o.duration_s, "stop after this many seconds; 0: run until stopped")
      ->check(CLI::Range(0.0, 1e6));
  app.add_option("--lcm-url", o.lcm_url, "where SIM_TRUTH and PARAMS go")->capture_default_str();
  app.add_flag("--no-lcm", o.no_lcm, "send nothing over LCM");
  app.add_flag("--check-config", o.check_config, "read scene and config, then stop");
  app.add_flag("--print-config", o.print_config,
               "print every key with its value and its meaning, then stop");
}

/// Nothing in it but a floor 0.3 m below the reel outlet.
Scene openFloor() {
  Scene scene;
  scene.name = "open floor";
  scene.floor = -0.3;
  return scene;
}

int run(const Options& o) {
  SimConfig config = o.config.empty() ? SimConfig{} : loadConfig<SimConfig>(o.config);
  if (o.rate_hz > 0.0) config.fotokite.forced_rate = o.rate_hz;
  const Scene scene = o.scene.empty() ? openFloor() : sceneInWorld(readScene(o.scene));
  const std::string effective = dumpConfig(config);
  if (o.print_config) {
    std::fputs(effective.c_str(), stdout);
    return static_cast<int>(ExitCode::kOk);
  }
  Simulator simulator(config, scene, o.seed);
  if (o.check_config) {
    std::puts("configuration is right");
    return static_cast<int>(ExitCode::kOk);
  }
  if (o.pty.empty()) {
    throw InputError({.file = {},
                      .line = 0,
                      .key = "--pty",
                      .problem = "missing",
                      .allowed = {},
                      .remedy = "name the terminal to make, e.g. --pty /tmp/tautline-fotokite"},
                     ExitCode::kUsage);
  }
  PtyLink pty(o.pty);
  TruthPublisher publisher(o.no_lcm ? std::string() : o.lcm_url, effective);
  if (!publisher.warning().empty()) {
    std::fprintf(stderr, "tautline-sim: warning: %s\n", publisher.warning().c_str());
  }
  std::printf(
      "tautline-sim %s: serving Fotokite protocol on %s (%s), scene \"%s\", seed %llu; stop with "
      "Ctrl-C\n",
      TAUTLINE_VERSION, o.pty.c_str(), pty.slave().c_str(), scene.name.c_str(),
      static_cast<unsigned long long>(o.seed));
  std::fflush(stdout);

  const ServerSummary summary =
      serve(simulator, pty, publisher, fromSeconds(o.duration_s), stop_requested);
  const Truth& truth = simulator.truth();
  std::printf("tautline-sim: stopped after %.1f s, %u client(s)%s%s", toSeconds(summary.served),
              summary.clients, truth.crashed ? ", crashed: " : "",
              truth.crashed ? nameOf(truth.crash_reason, kCrashReasonNames) : "");
  if (summary.time_lost > Duration::zero()) {
    std::printf(", %.2f s left out: this machine was too slow", toSeconds(summary.time_lost));
  }
  std::printf("\n");
  return static_cast<int>(ExitCode::kOk);
}

}  // namespace
}  // namespace tautline::sim

int main(int argc, char** argv) {
  using namespace tautline;
  CLI::App app{"Simulated drone, reel and tether behind the Fotokite ground station's protocol",
               "tautline-sim"};
  sim::Options options;
  sim::addOptions(app, options);
  std::signal(SIGTERM, sim::onSignal);
  std::signal(SIGINT, sim::onSignal);
  std::signal(SIGHUP, sim::onSignal);
  try {
    app.parse(argc, argv);
    return sim::run(options);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::kUsage);
  } catch (...) {
    return reportException("tautline-sim");
  }
}
