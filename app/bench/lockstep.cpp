#include "app/bench/lockstep.h"

#include <array>
#include <memory>
#include <string>

#include <tautline/sim_truth_t.hpp>

#include "app/station/fence_scene.h"
#include "app/station/mission_upload.h"
#include "app/station/operator_message.h"
#include "app/version.h"
#include "common/error.h"
#include "common/toml/config_file.h"
#include "drivers/cobs_port.h"
#include "drivers/fotokite_device.h"
#include "drivers/tautline_device.h"
#include "lcmtypes/channels.h"

namespace tautline::bench {
namespace {

constexpr Duration kTruthPeriod = std::chrono::milliseconds(20);
constexpr Duration kLoopPeriod = std::chrono::seconds(1);
constexpr Duration kHeartbeatPeriod = std::chrono::milliseconds(200);
constexpr Duration kSettle = std::chrono::seconds(1);
constexpr std::int64_t kSession = 1;  // the only operator there is

/// Null for a device that has no bus.
std::unique_ptr<FramePort> makeFrames(DeviceKind kind, BytePort& port) {
  switch (kind) {
    case DeviceKind::kFotokite:
      return nullptr;
    case DeviceKind::kTautlineSerial:
      return std::make_unique<CobsPort>(port);
    case DeviceKind::kTautlineCan:
    case DeviceKind::kReplay:
      break;
  }
  throw InputError({.key = "device",
                    .problem = std::string(nameOf(kind, kDeviceKindNames)) + " has no lock-step",
                    .allowed = "fotokite, tautline-serial"});
}

std::unique_ptr<Device> makeDevice(const StationConfig& config, BytePort& port, FramePort* frames) {
  if (frames == nullptr) return std::make_unique<FotokiteDevice>(port, config.fotokite);
  return std::make_unique<TautlineDevice>(*frames, config.tautline, "tautline-serial");
}

}  // namespace

StationConfig stationOf(const LockstepConfig& config, RunMode run_mode) {
  if (!config.world.start) {
    throw InputError({.key = "start_m",
                      .problem = "the scene has none",
                      .remedy = "say where the drone is parked"});
  }
  StationConfig station = config.station;
  station.run_mode = run_mode;
  station.core.guidance.home_position_m = *config.world.start;
  if (config.map_known) station.core.fence.obstacles = fenceObstaclesOf(config.world);
  return station;
}

sim::SimConfig simOf(const LockstepConfig& config) {
  sim::SimConfig sim = config.sim;
  sim.device = Lockstep::simDevice(config);
  return sim;
}

Scene worldOf(const LockstepConfig& config) {
  Scene world = config.world;
  world.boxes.insert(world.boxes.end(), config.unmapped.begin(), config.unmapped.end());
  return world;
}

Lockstep::Lockstep(const LockstepConfig& config, TelemetrySink* sink)
    : config_(stationOf(config, RunMode::kSim)),
      period_(fromSeconds(1.0 / config_.loop_rate_hz)),
      sim_device_(simDevice(config)),
      simulator_(simOf(config), worldOf(config), config.seed),
      faults_(config.seed),
      port_(simulator_),
      frames_(makeFrames(config_.device, port_)),
      device_(makeDevice(config_, port_, frames_.get())),
      station_(config_.core),
      floor_(config.world.floor) {
  input_.host.run_mode = config_.run_mode;
  input_.host.device = DeviceReality::kEmulated;
  if (sink == nullptr) return;
  sink_.emplace(*sink, faults_);
  telemetry_ = std::make_unique<Telemetry>(*sink_, config_.run_mode, Duration::zero(),
                                           fromSeconds(1.0 / config_.telemetry_rate_hz));
  telemetry_->setParams("tautline-bench", kVersion, dumpConfig(config_));
  telemetry_->setPlace("simulator");
  telemetry_->publishParams(now_);
}

const StepOutput& Lockstep::step(const std::optional<OperatorCommand>& command,
                                 const tautline::mission_chunk_t* chunk) {
  faults_.update(now_);
  const Duration late = faults_.lateness();
  now_ += period_ + late;
  simulator_.advanceTo(now_);
  if (simulator_.unplugged() != unplugged_) {
    unplugged_ = !unplugged_;
    unplugged_ ? port_.unplug() : port_.plug();
  }
  input_.now = now_ + faults_.clockAhead();
  device_->read(input_.now, input_.sensors);
  beat(command);
  input_.command = faults_.hear(command);
  input_.chunk = faults_.operatorCut() ? nullptr : chunk;
  input_.sticks = faults_.operatorCut() ? std::nullopt : sticks_;
  input_.missed_in_a_row = late > Duration::zero()
                               ? input_.missed_in_a_row + static_cast<std::int32_t>(late / period_)
                               : 0;
  const StepOutput& out = station_.step(input_);
  device_->write(input_.now, out.command);
  output_ = &out;
  statistics_.record(Duration::zero(), Duration::zero(), 0);
  if (telemetry_) {
    recordOperator();
    telemetry_->publish(input_, out);
    if (now_ >= next_truth_) recordTruth();
    if (now_ >= next_loop_) {
      next_loop_ = now_ + kLoopPeriod;
      telemetry_->publishLoop(now_, period_, statistics_.snapshot());
    }
  }
  return out;
}

sim::SimDevice Lockstep::simDevice(const LockstepConfig& config) noexcept {
  return config.station.device == DeviceKind::kFotokite ? sim::SimDevice::kFotokite
                                                        : sim::SimDevice::kTautlineSerial;
}

void Lockstep::inject(const sim::Fault& fault) {
  sim::checkFault(fault, sim_device_, true);
  const FaultOwner owner = ownerOf(fault);
  if ((owner.bench && !faults_.add(fault)) || (owner.machine && !simulator_.inject(fault)))
    throw sim::tooManyFaults(fault);
}

/// The operator of the last command lives on, as the command line does while it waits.
void Lockstep::beat(const std::optional<OperatorCommand>& command) noexcept {
  if (command) session_ = command->session;
  input_.heartbeat.reset();
  if (session_ == 0 || silent_ || faults_.operatorCut() || now_ < next_heartbeat_) return;
  next_heartbeat_ = now_ + kHeartbeatPeriod;
  input_.heartbeat = Heartbeat{session_, operatorName("bench")};
}

template <class Message>
void Lockstep::record(const char* channel, Message message) noexcept {
  std::array<std::uint8_t, 4096> buffer{};
  message.utime = toMicroseconds(input_.now);
  const int size = message.encode(buffer.data(), 0, static_cast<int>(buffer.size()));
  if (size > 0)
    sink_->publish(channel, message.utime, {buffer.data(), static_cast<std::size_t>(size)});
}

/// What lcm-logger would have heard of the operator.
void Lockstep::recordOperator() noexcept {
  if (input_.command) {
    record(channel::kOperatorCommand, messageOf(*input_.command));
  }
  if (input_.chunk != nullptr) record(channel::kMissionChunk, *input_.chunk);
}

void Lockstep::recordTruth() noexcept {
  next_truth_ = now_ + kTruthPeriod;
  tautline::sim_truth_t message{};
  sim::fillTruth(truth(), 0, message);
  record(channel::kSimTruth, message);
}

namespace {

/// One cycle of a scripted flight at a time.
struct Script {
  Lockstep& bench;
  std::uint64_t mission;
  Time end;
  const std::function<void(const Lockstep&)>& each_cycle;
  std::int64_t sequence{0};

  bool cycle(const std::optional<OperatorCommand>& command = {},
             const tautline::mission_chunk_t* chunk = nullptr) {
    const StepOutput& out = bench.step(command, chunk);
    if (each_cycle) each_cycle(bench);
    return out.ack && out.ack->result == AckResult::kAccepted;
  }
  bool ask(Request request) {
    return cycle(OperatorCommand{kSession, ++sequence, request, mission});
  }
  [[nodiscard]] bool over() const { return bench.now() >= end || bench.truth().crashed; }
  bool flyUntil(Mode mode) {
    while (!over() && bench.output().supervision.mode != mode) cycle();
    return !over();
  }
};

}  // namespace

MissionStart beginMission(Lockstep& bench, const MissionPlan& mission, Time end,
                          const std::function<void(const Lockstep&)>& each_cycle) {
  MissionStart start;
  Script script{bench, mission.hash, end, each_cycle};
  // Telemetry has to run for a moment before the station lets itself be armed.
  while (!start.armed && !script.over()) {
    for (int i = 0; i < 50; ++i) script.cycle();
    start.armed = script.ask(Request::kArm);
  }
  start.took_off = start.armed && script.ask(Request::kTakeoff) && script.flyUntil(Mode::kHold);
  if (start.took_off) {
    forEachChunk(mission, [&](tautline::mission_chunk_t& chunk) {
      chunk.session = kSession;
      chunk.sequence = ++script.sequence;
      return script.cycle({}, &chunk);
    });
    start.navigating = script.ask(Request::kNavigate);
  }
  start.sequence = script.sequence;
  return start;
}

FlightResult flyMission(Lockstep& bench, const MissionPlan& mission, Duration limit,
                        const std::function<void(const Lockstep&)>& each_cycle) {
  FlightResult result;
  const Time end = bench.now() + limit;
  const MissionStart start = beginMission(bench, mission, end, each_cycle);
  Script script{bench, mission.hash, end, each_cycle, start.sequence};
  result.armed = start.armed;
  result.took_off = start.took_off;
  if (start.took_off) {
    if (start.navigating) script.flyUntil(Mode::kHold);
    result.completed = bench.output().mission.state == MissionState::kCompleted;
  }
  if (!script.over() && bench.output().supervision.mode != Mode::kStandby) {
    script.ask(Request::kLand);
    script.flyUntil(Mode::kStandby);
    for (const Time settled = bench.now() + kSettle; bench.now() < settled;)
      script.cycle();  // the last centimetres, rotors off
    result.landed = bench.output().supervision.mode == Mode::kStandby && bench.truth().on_ground &&
                    !bench.truth().motors_on && !bench.truth().crashed;
  }
  result.crash = bench.truth().crash_reason;
  result.duration = bench.now() - Time{};
  return result;
}

}  // namespace tautline::bench
