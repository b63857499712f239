#include "app/bench/hil_rig.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include <fmt/format.h>
#include <tautline/command_ack_t.hpp>
#include <tautline/sim_fault_t.hpp>

#include "app/cli/termination.h"
#include "app/station/operator_message.h"
#include "common/clock.h"
#include "common/mission/scene.h"
#include "common/toml/config_file.h"
#include "lcmtypes/channels.h"
#include "lcmtypes/lcm_access.h"
#include "sim_hil/fault.h"

namespace tautline::bench {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

// State of the station and the truth are up to 50 ms old when the next come, and the simulator
// catches up with at most 100 ms that the machine did not give it.
constexpr Duration kAllowance = milliseconds(150);
constexpr Duration kStartUp = seconds(10);
constexpr Duration kSilence = milliseconds(100);  // of the station; then the rig's own clock counts
constexpr milliseconds kLook{5};
constexpr int kFlights = 3;   // while the machine cannot keep up
constexpr int kCopies = 3;    // of a fault: UDP may lose a packet
constexpr int kQueue = 4096;  // messages of each channel, while this process does not run

InputError failed(const std::string& problem) {
  return InputError({.problem = problem}, ExitCode::kFailed);
}

/// A port for each process, so that flights do not hear each other nor anybody else.
std::string ownLcmUrl() {
  constexpr int kFirstPort = 10000;
  constexpr int kPorts = 50000;
  return fmt::format("udpm://239.255.76.67:{}?ttl=0", kFirstPort + ::getpid() % kPorts);
}

StationConfig stationIn(const fs::path& folder, const LockstepConfig& config) {
  StationConfig station = stationOf(config, RunMode::kHil);
  if (station.device != DeviceKind::kFotokite && station.device != DeviceKind::kTautlineSerial) {
    throw InputError({.key = "device",
                      .problem = std::string(nameOf(station.device, kDeviceKindNames)) +
                                 " is on no pseudo terminal",
                      .allowed = "fotokite, tautline-serial"});
  }
  station.serial.device = (folder / "device").string();
  station.black_box = (folder / "black_box").string();
  return station;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  const fs::path memory = "/dev/shm";
  const bool in_memory = std::getenv("TMPDIR") == nullptr && ::access(memory.c_str(), W_OK) == 0;
  std::string name =
      ((in_memory ? memory : fs::temp_directory_path()) / "tautline-hil-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw InputError({.file = name,
                      .problem = std::string("cannot be made: ") + std::strerror(errno),
                      .remedy = "set TMPDIR to a folder that can be written"},
                     ExitCode::kFailed);
  }
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

HilRig::HilRig(const LockstepConfig& config, TelemetrySink* sink)
    : sim_device_(Lockstep::simDevice(config)),
      floor_(config.world.floor),
      sink_(sink),
      lcm_url_(ownLcmUrl()),
      lcm_(reachable(lcm_url_)),
      operator_(lcm_),
      faults_(config.seed) {
  if (!lcm_.good()) throw cannotJoin(lcm_url_);
  lcm_.subscribe(".*", &HilRig::onMessage, this)->setQueueCapacity(kQueue);
  const fs::path& folder = folder_.path();
  config_ = stationIn(folder, config);
  const auto file = [&](const char* name, const std::string& text) {
    writeFileAtomically(folder / name, text);
    return (folder / name).string();
  };
  const std::string station_file = file("station.toml", dumpConfig(config_));
  const std::string sim_file = file("sim.toml", dumpConfig(simOf(config)));
  const std::string scene_file = file("world.scene.toml", sceneText(worldOf(config)));

  simulator_.emplace(
      programBeside("tautline-sim"),
      std::vector<std::string>{"--pty", config_.serial.device, "--scene", scene_file, "--config",
                               sim_file, "--seed", std::to_string(config.seed), "--lcm-url",
                               lcm_url_, "--take-faults"},
      folder);
  if (!listenUntil([&] { return fs::is_symlink(config_.serial.device); }, kStartUp))
    throw failed("tautline-sim opens no terminal: " + simulator_->lastLine());
  station_program_.emplace(
      programBeside("tautline-station"),
      std::vector<std::string>{"--config", station_file, "--lcm-url", lcm_url_}, folder);
  if (!listenUntil([&] { return heard_.begun(); }, kStartUp))
    throw failed("tautline-station and tautline-sim are not heard: " +
                 station_program_->lastLine());
  start_ = last_cycle_ = *heard_.next();
}

const StepOutput& HilRig::step(const std::optional<OperatorCommand>& command,
                               const tautline::mission_chunk_t* chunk) {
  faults_.update(now_);
  Time not_before = last_cycle_;
  if (const Duration late = faults_.lateness(); late > Duration::zero()) {
    station_program_->standStill(late);
    not_before = monotonicNow();  // what it had begun before is not the cycle that comes late
  }
  if (const auto heard = faults_.hear(command)) operator_.say(*heard);
  if (chunk != nullptr && !faults_.operatorCut()) operator_.say(*chunk);

  heard_.goOn();
  const bool whole =
      listenUntil([&] { return heard_.next() && *heard_.next() >= not_before; }, kSilence);
  if (whole) {
    const Duration stall = *heard_.next() - std::max(last_cycle_, not_before);
    longest_stall_ = std::max(longest_stall_, stall);
    last_cycle_ = *heard_.next();
  } else {
    heard_.fallSilent();
  }
  now_ = std::max(now_, Time{} + (whole ? last_cycle_ - start_ : sinceStart()));
  return heard_.output();
}

template <class Done>
bool HilRig::listenUntil(const Done& done, Duration patience) {
  checkPrograms();
  const Time end = monotonicNow() + patience;
  while (!done()) {
    if (monotonicNow() >= end) return false;
    operator_.send(faults_.operatorCut());
    lcm_.handleTimeout(static_cast<int>(kLook.count()));
    checkPrograms();
  }
  return true;
}

void HilRig::checkPrograms() {
  if (cli::termination_requested) throw failed("interrupted");
  for (auto* program : {&simulator_, &station_program_}) {
    if (!*program) continue;
    if (const std::string how = (*program)->ended(); !how.empty()) throw failed(how);
  }
}

void HilRig::onMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
  const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
  if (sink_ != nullptr) sink_->publish(channel.c_str(), buffer->recv_utime, bytes);
  heard_.take(channel, bytes);
  if (channel != channel::kCommandAck) return;
  if (const auto ack =
          decodeExactly<tautline::command_ack_t>(bytes.data(), static_cast<int>(bytes.size())))
    operator_.hear(*ack);
}

void HilRig::inject(const sim::Fault& fault) {
  sim::checkFault(fault, sim_device_, true);
  const FaultOwner owner = ownerOf(fault);
  if (owner.bench && !faults_.add(fault)) throw sim::tooManyFaults(fault);
  if (owner.machine) tell(fault);
}

void HilRig::tell(const sim::Fault& fault) {
  sim::Fault from_now = fault;
  from_now.at = std::max(Time{}, fault.at - sinceStart());
  last_fault_utime_ =
      std::max(last_fault_utime_ + 1, toMicroseconds(monotonicNow() + unixOffset()));
  tautline::sim_fault_t message;
  message.utime = last_fault_utime_;
  message.fault = sim::faultText(from_now);
  for (int i = 0; i < kCopies; ++i) lcm_.publish(channel::kSimFault, &message);
}

Duration HilRig::sinceStart() const noexcept { return monotonicNow() - start_; }

Duration HilRig::allowance() const noexcept { return kAllowance; }

HilRig::End HilRig::end() {
  End end;
  end.failure = station_program_->end();
  const std::string simulator = simulator_->end();
  if (end.failure.empty()) end.failure = simulator;
  if (const std::string last = simulator_->lastLine(); last.find("left out") != std::string::npos)
    end.slowness = last;
  if (longest_stall_ > kAllowance) {
    end.slowness += fmt::format("{}tautline-station stood still for {:.2f} s",
                                end.slowness.empty() ? "" : "; ", toSeconds(longest_stall_));
  }
  return end;
}

std::string whyOnlyInLockstep(const FlightCase& flight) {
  for (const FaultPlan& plan : flight.faults) {
    const sim::Fault& fault = plan.fault;
    if (fault.target == sim::FaultTarget::kLcm && fault.mode != sim::FaultMode::kOk)
      return describe(fault) + ": the bench itself hears the station over LCM";
    if (fault.target == sim::FaultTarget::kLoop && fault.mode == sim::FaultMode::kWrong)
      return describe(fault) + ": one clock is the whole machine's, and nobody can set it forward";
  }
  return {};
}

CaseResult runCaseInHil(const FlightCase& flight, TelemetrySink* sink) {
  CaseResult result;
  const Time began = monotonicNow();
  for (int flights = 1;; ++flights) {
    result = resultOf(flight);
    HilRig::End end;
    try {
      HilRig rig(flight.bench, sink);
      result = runCase(flight, rig);
      end = rig.end();
      if (result.failure.empty()) result.failure = end.failure;
    } catch (const InputError& e) {
      result.failure = e.what();
    }
    result.flights = flights;
    if (result.failure.empty() || end.slowness.empty()) break;
    result.failure += fmt::format(" (this machine was too slow: {})", end.slowness);
    if (flights == kFlights) break;
  }
  result.wall_s = toSeconds(monotonicNow() - began);
  return result;
}

}  // namespace tautline::bench
