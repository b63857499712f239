/// @file
/// `tautline-sim`: the simulated drone, reel and tether behind the wire protocol of a real device.

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "common/error.h"
#include "common/mission/scene.h"
#include "common/toml/config_file.h"
#include "lcmtypes/channels.h"
#include "sim_hil/can_link.h"
#include "sim_hil/dispersion.h"
#include "sim_hil/fault.h"
#include "sim_hil/fault_file.h"
#include "sim_hil/fault_inbox.h"
#include "sim_hil/pty_link.h"
#include "sim_hil/real_time_server.h"
#include "sim_hil/sim_config.h"
#include "sim_hil/simulator.h"
#include "sim_hil/truth_publisher.h"
#include "sim_hil/tty_link.h"

namespace tautline::sim {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void onSignal(int /*signal*/) { stop_requested = 1; }

struct Options {
  std::string device;
  std::string pty;
  std::string can;
  std::string slcan;
  std::string scene;
  std::string config;
  std::uint64_t seed{1};
  double rate_hz{0.0};
  double duration_s{0.0};
  std::string lcm_url{kDefaultLcmUrl};
  std::vector<std::string> faults;
  std::string scenario;
  bool take_faults{false};
  bool no_lcm{false};
  bool check_config{false};
  bool print_config{false};
};

void addOptions(CLI::App& app, Options& o) {
  app.set_version_flag("--version", TAUTLINE_VERSION);
  app.add_option("--pty", o.pty,
                 "make this a link to the device's terminal, e.g. /tmp/tautline-fotokite");
  app.add_option("--device", o.device,
                 "what is served on --pty: fotokite (default) or tautline-serial")
      ->check(CLI::IsMember({"fotokite", "tautline-serial"}));
  app.add_option("--can", o.can, "serve the Tautline bus on this CAN interface, e.g. vcan0");
  app.add_option("--slcan", o.slcan,
                 "serve the Tautline bus as a CAN adapter with SLCAN text: on this serial line if "
                 "there is one, on a terminal with this link otherwise");
  app.add_option("--scene", o.scene,
                 "*.scene.toml: room, obstacles, reel, start (default: an open floor)");
  app.add_option("--config", o.config, "properties of the machine, see config/sim.toml");
  app.add_option("--seed", o.seed, "of gusts, sensor noise and, with [dispersion], of the machine")
      ->capture_default_str();
  app.add_option("--rate-hz", o.rate_hz, "telemetry rate, whatever the client asks for")
      ->check(CLI::Range(0.1, 500.0));
  app.add_option("--duration", o.duration_s, "stop after this many seconds; 0: run until stopped")
      ->check(CLI::Range(0.0, 1e6));
  app.add_option("--lcm-url", o.lcm_url, "where SIM_TRUTH and PARAMS go")->capture_default_str();
  app.add_option("--fault", o.faults,
                 "\"TARGET MODE AT_S [FOR_S [VALUE]]\", e.g. \"encoder stuck 10 5\"; may be given "
                 "again; see `tautline-sim faults`")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--scenario", o.scenario, "take the faults of this scenario file");
  CLI::Option* no_lcm = app.add_flag("--no-lcm", o.no_lcm, "send nothing over LCM");
  app.add_flag("--take-faults", o.take_faults,
               "also take faults over LCM while it runs (SIM_FAULT)")
      ->excludes(no_lcm);
  app.add_flag("--check-config", o.check_config, "read scene and config, then stop");
  app.add_flag("--print-config", o.print_config,
               "print every key with its value and its meaning, then stop");
}

const char* protocolOf(SimDevice device) {
  return device == SimDevice::kFotokite ? "Fotokite protocol" : "Tautline bus";
}

/// Nothing in it but a floor 0.3 m below the reel outlet.
Scene openFloor() {
  Scene scene;
  scene.name = "open floor";
  scene.floor = -0.3;
  return scene;
}

/// What is served where; exactly one place.
void chooseDevice(const Options& o, SimConfig& config) {
  const int places = (o.pty.empty() ? 0 : 1) + (o.can.empty() ? 0 : 1) + (o.slcan.empty() ? 0 : 1);
  if (places > 1 || (!o.device.empty() && o.pty.empty() && places > 0)) {
    throw InputError({.key = "--pty, --can, --slcan",
                      .problem = "more than one place to serve",
                      .remedy = "choose one; --device goes with --pty"},
                     ExitCode::kUsage);
  }
  if (o.device == "fotokite") config.device = SimDevice::kFotokite;
  if (o.device == "tautline-serial") config.device = SimDevice::kTautlineSerial;
  if (!o.can.empty()) config.device = SimDevice::kTautlineCan;
  if (!o.slcan.empty()) config.device = SimDevice::kTautlineSlcan;
}

std::unique_ptr<ByteLink> openLink(const Options& o, SimDevice device) {
  if (!o.can.empty()) return std::make_unique<CanLink>(o.can);
  if (!o.slcan.empty() && std::filesystem::is_character_file(o.slcan) &&
      !std::filesystem::is_symlink(o.slcan))
    return std::make_unique<TtyLink>(o.slcan);
  const std::string& link = o.slcan.empty() ? o.pty : o.slcan;
  if (link.empty() || device == SimDevice::kTautlineCan) {
    throw InputError(
        {.key = "--pty",
         .problem = "missing",
         .remedy = "say where to serve, e.g. --pty /tmp/tautline-fotokite or --can vcan0"},
        ExitCode::kUsage);
  }
  return std::make_unique<PtyLink>(link);
}

/// What can be made to go wrong, as a table.
void showFaults() {
  std::printf("%-14s %-13s %-8s  %s\n", "target", "mode", "value", "effect (where it can be had)");
  for (const FaultKind& kind : faultMenu()) {
    char value[24] = "-";
    if (kind.value[0] != '\0') std::snprintf(value, sizeof value, "%g", kind.initial);
    std::printf("%-14s %-13s %-8s  %s%s%s (%s)\n", nameOf(kind.target, kFaultTargetNames),
                nameOf(kind.mode, kFaultModeNames), value, kind.effect,
                kind.value[0] != '\0' ? "; value: " : "", kind.value,
                nameOf(kind.place, kFaultPlaceNames));
  }
  const auto list = [](const char* title, std::span<const VehicleCode> codes) {
    std::printf("%s", title);
    for (const VehicleCode& c : codes) std::printf(" %s%s", c.name, c.tautline < 0 ? "" : "*");
    std::printf("\n");
  };
  list("flag:NAME   ", vehicleFlags());
  list("mode:NAME   ", vehicleFlightModes());
  std::printf("*: on the Tautline bus too. Mode ok: nothing is wrong with the target meanwhile.\n");
}

/// Faults of the command line and of the scenario file, in this order.
std::vector<Fault> chooseFaults(const Options& o, SimDevice device) {
  std::vector<Fault> faults;
  for (const std::string& text : o.faults) {
    faults.push_back(parseFault(text));
    checkFault(faults.back(), device, false);
  }
  if (o.scenario.empty()) return faults;
  TomlTable root = TomlFile::load(o.scenario).root();
  for (const FaultEntry& entry : readFaults(root)) {
    if (!entry.phase.empty()) {
      throw InputError({.file = o.scenario,
                        .key = describe(entry.fault),
                        .problem = "begins with the station's phase \"" + entry.phase +
                                   "\", which the machine does not know",
                        .remedy = "leave phase out and count at_s from the simulator's start, or "
                                  "fly it with tautline-bench scenario"});
    }
    checkFault(entry.fault, device, false);
    faults.push_back(entry.fault);
  }
  return faults;
}

void inject(Simulator& simulator, const std::vector<Fault>& faults) {
  for (const Fault& fault : faults) {
    if (!simulator.inject(fault)) throw tooManyFaults(fault);
  }
}

int run(const Options& o) {
  SimConfig config = o.config.empty() ? SimConfig{} : loadConfig<SimConfig>(o.config);
  chooseDevice(o, config);
  if (o.rate_hz > 0.0) config.fotokite.forced_rate = config.tautline.sensor_rate = o.rate_hz;
  const Scene scene = o.scene.empty() ? openFloor() : sceneInWorld(readScene(o.scene));
  if (o.print_config) {
    std::fputs(dumpConfig(config).c_str(), stdout);
    return static_cast<int>(ExitCode::kOk);
  }
  config = dispersed(config, o.seed);  // what flies, and so what PARAMS says
  Simulator simulator(config, scene, o.seed);
  inject(simulator, chooseFaults(o, config.device));
  if (o.check_config) {
    std::puts("configuration is right");
    return static_cast<int>(ExitCode::kOk);
  }
  const std::unique_ptr<ByteLink> link = openLink(o, config.device);
  TruthPublisher publisher(o.no_lcm ? std::string() : o.lcm_url, dumpConfig(config));
  if (!publisher.warning().empty()) {
    std::fprintf(stderr, "tautline-sim: warning: %s\n", publisher.warning().c_str());
  }
  std::optional<FaultInbox> inbox;
  if (o.take_faults) inbox.emplace(o.lcm_url, config.device);
  std::printf("tautline-sim %s: serving %s on %s (%s), scene \"%s\", seed %llu; stop with Ctrl-C\n",
              TAUTLINE_VERSION, protocolOf(config.device), (o.pty + o.can + o.slcan).c_str(),
              link->name().c_str(), scene.name.c_str(), static_cast<unsigned long long>(o.seed));
  std::fflush(stdout);

  const ServerSummary summary = serve(simulator, *link, publisher, inbox ? &*inbox : nullptr,
                                      fromSeconds(o.duration_s), stop_requested);
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
  CLI::App app{
      "Simulated drone, reel and tether behind the Fotokite ground station's protocol or the "
      "Tautline "
      "bus",
      "tautline-sim"};
  sim::Options options;
  sim::addOptions(app, options);
  const CLI::App* faults =
      app.add_subcommand("faults", "List what can be made to go wrong, then stop");
  std::signal(SIGTERM, sim::onSignal);
  std::signal(SIGINT, sim::onSignal);
  std::signal(SIGHUP, sim::onSignal);
  try {
    app.parse(argc, argv);
    if (faults->parsed()) {
      sim::showFaults();
      return static_cast<int>(ExitCode::kOk);
    }
    return sim::run(options);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::kUsage);
  } catch (...) {
    return reportException("tautline-sim");
  }
}
