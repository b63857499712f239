#include "app/bench/benchmark/recorded_flight.h"

#include <cstring>

#include "app/station/input_message.h"
#include "common/error.h"
#include "common/mission/scene.h"
#include "common/toml/config_file.h"
#include "lcmtypes/channels.h"

namespace tautline::bench {
namespace {

/// Keeps inputs and pieces of missions; the piece of a cycle is published before its input.
class InputKeeper final : public TelemetrySink {
 public:
  explicit InputKeeper(RecordedFlight& flight) : flight_(flight) {}

  bool publish(const char* channel, std::int64_t,
               std::span<const std::uint8_t> bytes) noexcept override {
    const int size = static_cast<int>(bytes.size());
    if (std::strcmp(channel, channel::kMissionChunk) == 0) {
      flight_.chunks.emplace_back().decode(bytes.data(), 0, size);
    } else if (std::strcmp(channel, channel::kStationInput) == 0) {
      tautline::station_input_t message;
      message.decode(bytes.data(), 0, size);
      StepInput& in = flight_.cycles.emplace_back(inputOf(message));
      if (message.chunk_sequence != 0) in.chunk = &flight_.chunks.back();
    }
    return true;
  }

 private:
  RecordedFlight& flight_;
};

}  // namespace

RecordedFlight recordFlight(const std::filesystem::path& config_folder, const std::string& mission,
                            const std::string& scene) {
  RecordedFlight flight;
  flight.config.station = loadConfig<StationConfig>(config_folder / "station.toml");
  flight.config.sim = loadConfig<sim::SimConfig>(config_folder / "sim.toml");
  flight.config.world = sceneInWorld(readScene(config_folder / "scenes" / (scene + ".scene.toml")));
  flight.mission = readMission(config_folder / "missions" / (mission + ".mission.toml"));
  InputKeeper keeper(flight);
  Lockstep bench(flight.config, &keeper);
  flight.config.station.core.guidance.home_position_m = flight.config.world.start.value();
  const FlightResult result = flyMission(bench, *flight.mission.plan, std::chrono::seconds(900));
  if (!result.completed || !result.landed)
    throw InputError({.key = mission, .problem = "was not flown to its end"}, ExitCode::kFailed);
  return flight;
}

}  // namespace tautline::bench
