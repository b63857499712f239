#pragma once

/// @file
/// The station's core, its real driver and the simulated machine in one process on one virtual
/// clock: the lock-step rung of the bench, with a Fotokite or with the Tautline bus over its serial
/// wire. Faster than real time; the same seed gives the same log,
/// byte for byte.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "app/bench/bench_faults.h"
#include "app/bench/memory_port.h"
#include "app/bench/rig.h"
#include "app/station/station.h"
#include "app/station/station_config.h"
#include "app/station/telemetry.h"
#include "common/mission/mission_file.h"
#include "common/mission/scene.h"
#include "drivers/bus_frame.h"
#include "drivers/device.h"
#include "sim_hil/sim_config.h"
#include "sim_hil/simulator.h"

namespace tautline::bench {

struct LockstepConfig {
  StationConfig station;
  sim::SimConfig sim;
  Scene world;                  ///< In W, with a start.
  bool map_known{true};         ///< The station has the scene's obstacles as its map.
  std::vector<Box> unmapped{};  ///< In W; the world has them too, and no map.
  std::uint64_t seed{1};
};

/// What the station is told of a flight in this run mode: home and map are the scene's. Throws
/// InputError for a scene without a start.
[[nodiscard]] StationConfig stationOf(const LockstepConfig& config, RunMode run_mode);
/// What the machine is told: its device is the station's.
[[nodiscard]] sim::SimConfig simOf(const LockstepConfig& config);
/// Where it flies, with what no map has.
[[nodiscard]] Scene worldOf(const LockstepConfig& config);

/// One flight. The bench is the operator: it arms, takes off, navigates and lands as the command
/// line would.
class Lockstep final : public Rig {
 public:
  /// `sink` gets every message of station and simulator, and outlives the bench; null: none. Throws
  /// InputError.
  Lockstep(const LockstepConfig& config, TelemetrySink* sink);

  /// The emulated device of a flight with this configuration.
  [[nodiscard]] static sim::SimDevice simDevice(const LockstepConfig& config) noexcept;

  /// One cycle, with an operator's command or a piece of a mission if there is one.
  const StepOutput& step(const std::optional<OperatorCommand>& command = {},
                         const tautline::mission_chunk_t* chunk = nullptr) override;

  /// Schedules a fault of machine or bench; a time that is past means now. Throws InputError if
  /// this device cannot have it, or if too many are scheduled already.
  void inject(const sim::Fault& fault) override;

  [[nodiscard]] Time now() const noexcept override { return now_; }
  [[nodiscard]] const StationConfig& station() const noexcept override { return config_; }
  [[nodiscard]] const StepOutput& output() const noexcept override { return *output_; }
  [[nodiscard]] const sim::Truth& truth() const noexcept override { return simulator_.truth(); }
  [[nodiscard]] const SensorFrame& sensors() const noexcept override { return input_.sensors; }
  [[nodiscard]] double floor() const noexcept override { return floor_; }
  [[nodiscard]] Duration allowance() const noexcept override { return Duration::zero(); }
  [[nodiscard]] MemoryPort& port() noexcept { return port_; }

  void holdSticks(const std::optional<Sticks>& sticks) noexcept override { sticks_ = sticks; }
  /// The operator's program stops, or runs again: heartbeats.
  void silence(bool silent) noexcept { silent_ = silent; }

 private:
  template <class Message>
  void record(const char* channel, Message message) noexcept;
  void beat(const std::optional<OperatorCommand>& command) noexcept;
  void recordOperator() noexcept;
  void recordTruth() noexcept;

  StationConfig config_;  ///< Effective: mode and home are the bench's.
  Duration period_;
  sim::SimDevice sim_device_;
  sim::Simulator simulator_;
  BenchFaults faults_;
  MemoryPort port_;
  std::unique_ptr<FramePort> frames_;  ///< On the Tautline bus only.
  std::unique_ptr<Device> device_;
  Station station_;
  std::optional<FaultySink> sink_;
  std::unique_ptr<Telemetry> telemetry_;
  StepInput input_;
  const StepOutput* output_{nullptr};
  Time now_{};
  std::int64_t session_{0};  ///< Of the operator who sent the last command; 0: none yet.
  bool silent_{false};
  std::optional<Sticks> sticks_;
  Time next_heartbeat_{};
  Time next_truth_{};
  Time next_loop_{};
  LoopStatistics statistics_;
  double floor_;
  bool unplugged_{false};
};

/// How a scripted flight ended.
struct FlightResult {
  bool armed{false};
  bool took_off{false};
  bool completed{false};
  bool landed{false};
  sim::CrashReason crash{sim::CrashReason::kNone};
  Duration duration{};  ///< Virtual time from start to end.
};

/// The beginning of a scripted flight: what the operator got.
struct MissionStart {
  bool armed{false};
  bool took_off{false};
  bool navigating{false};    ///< The mission was accepted; its first cycle has been.
  std::int64_t sequence{0};  ///< Of the operator's last message.
};

/// Arms, takes off, sends `mission` and asks for it; gives up at `end` or with a crash.
/// `each_cycle` (may be empty) is called after every cycle.
MissionStart beginMission(Lockstep& bench, const MissionPlan& mission, Time end,
                          const std::function<void(const Lockstep&)>& each_cycle = {});

/// Arms, takes off, flies `mission` and lands; gives up at `limit` of virtual time. `each_cycle`
/// (may be empty) is called after every cycle.
FlightResult flyMission(Lockstep& bench, const MissionPlan& mission, Duration limit,
                        const std::function<void(const Lockstep&)>& each_cycle = {});

}  // namespace tautline::bench
