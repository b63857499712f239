#pragma once

/// @file
/// A flight on the lock-step bench with the test as its operator.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "app/bench/lockstep.h"
#include "app/station/mission_upload.h"
#include "common/mission/mission_file.h"
#include "common/toml/config_file.h"

namespace tautline::bench {

inline const std::filesystem::path kConfig = std::filesystem::path(TAUTLINE_SOURCE_DIR) / "config";

inline LockstepConfig benchConfig(const std::string& scene, std::uint64_t seed,
                                  const std::string& station = "station") {
  LockstepConfig config;
  config.station = loadConfig<StationConfig>(kConfig / (station + ".toml"));
  config.sim = loadConfig<sim::SimConfig>(kConfig / "sim.toml");
  config.world = sceneInWorld(readScene(kConfig / "scenes" / (scene + ".scene.toml")));
  config.seed = seed;
  return config;
}

inline LockstepConfig busConfig(const std::string& scene, std::uint64_t seed) {
  return benchConfig(scene, seed, "station_tautline_serial");
}

inline Mission mission(const std::string& name) {
  return readMission(kConfig / "missions" / (name + ".mission.toml"));
}

class BenchFlight {
 public:
  explicit BenchFlight(const LockstepConfig& config, TelemetrySink* sink = nullptr)
      : bench(std::make_unique<Lockstep>(config, sink)) {}

  std::unique_ptr<Lockstep> bench;
  std::function<void()> each_cycle;  ///< Called after every cycle; may be empty.

  bool step(const std::optional<OperatorCommand>& command = {},
            const tautline::mission_chunk_t* chunk = nullptr) {
    const StepOutput& out = bench->step(command, chunk);
    if (each_cycle) each_cycle();
    return out.ack && out.ack->result == AckResult::kAccepted;
  }
  bool ask(Request request) { return step(OperatorCommand{kSession, ++sequence_, request, hash_}); }
  void upload(const MissionPlan& plan) {
    hash_ = plan.hash;
    forEachChunk(plan, [&](tautline::mission_chunk_t& chunk) {
      chunk.session = kSession;
      chunk.sequence = ++sequence_;
      return step({}, &chunk);
    });
  }
  bool navigate(const MissionPlan& plan) {
    upload(plan);
    return ask(Request::kNavigate);
  }
  [[nodiscard]] const StepOutput& output() const { return bench->output(); }
  [[nodiscard]] const sim::Truth& truth() const { return bench->truth(); }
  [[nodiscard]] Mode mode() const { return output().supervision.mode; }

  void wait(Duration d) {
    for (const Time end = bench->now() + d; bench->now() < end;) step();
  }
  bool until(const std::function<bool()>& done, Duration limit) {
    for (const Time end = bench->now() + limit; bench->now() < end && !done();) step();
    return done();
  }
  bool until(Mode wanted, Duration limit) {
    return until([&] { return mode() == wanted; }, limit);
  }
  /// Telemetry has to run for a moment before the station lets itself be armed.
  bool takeOff() {
    wait(std::chrono::seconds(3));
    return ask(Request::kArm) && ask(Request::kTakeoff) &&
           until(Mode::kHold, std::chrono::seconds(30));
  }
  /// In STANDBY, with the last centimetres fallen and the rotors off.
  bool landed(Duration limit) {
    if (!until(Mode::kStandby, limit)) return false;
    wait(std::chrono::seconds(1));
    return truth().on_ground && !truth().motors_on && !truth().crashed;
  }

 private:
  static constexpr std::int64_t kSession = 7;

  std::int32_t sequence_{0};
  std::uint64_t hash_{0};
};

}  // namespace tautline::bench
