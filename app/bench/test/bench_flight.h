#pragma once

/// @file
/// The shipped configuration, scenes and missions for flights in lock-step.

#include <filesystem>
#include <string>

#include "app/bench/lockstep.h"
#include "common/toml/config_file.h"

namespace tautline::bench {

inline const std::filesystem::path kConfig = std::filesystem::path(TAUTLINE_SOURCE_DIR) / "config";

inline LockstepConfig benchConfig(const std::string& scene, std::uint64_t seed) {
  LockstepConfig config;
  config.station = loadConfig<StationConfig>(kConfig / "station.toml");
  config.sim = loadConfig<sim::SimConfig>(kConfig / "sim.toml");
  config.world = sceneInWorld(readScene(kConfig / "scenes" / (scene + ".scene.toml")));
  config.seed = seed;
  return config;
}

inline LockstepConfig busConfig(const std::string& scene, std::uint64_t seed) {
  LockstepConfig config = benchConfig(scene, seed);
  config.station = loadConfig<StationConfig>(kConfig / "station_tautline_serial.toml");
  return config;
}

inline Mission mission(const std::string& name) {
  return readMission(kConfig / "missions" / (name + ".mission.toml"));
}

}  // namespace tautline::bench
