#include "app/experiments/setup.h"

#include "common/mission/mission_file.h"
#include "common/toml/config_file.h"
#include "common/toml/toml_file.h"

namespace tautline::experiments {

std::string Setup::fingerprint() const {
  std::string text = readTextFile("/proc/self/exe");
  text += dumpConfig(plant) + dumpConfig(as_published) + dumpConfig(tautline);
  text += (quick ? "quick " : "whole ") + std::to_string(seed);
  return hashText(fnv1a(text));
}

void pullWith(bench::LockstepConfig& flight, double tension) {
  CoreConfig& core = flight.station.core;
  flight.sim.vehicle.tension = tension;
  core.localizer.nominal_tension_n = tension;
  core.executor.target.nominal_tension_n = tension;
  core.control.composite.feed_forward.nominal_tension_n = tension;
  core.control.position.target.nominal_tension_n = tension;
}

Setup loadSetup(const std::filesystem::path& folder, bool quick, std::uint64_t seed) {
  Setup setup;
  setup.folder = folder;
  setup.quick = quick;
  setup.seed = seed;
  setup.plant = loadConfig<sim::SimConfig>(folder / "plant.toml");
  setup.as_published = loadConfig<StationConfig>(folder / "as_published.toml");
  setup.tautline = loadConfig<StationConfig>(folder / "tautline.toml");
  return setup;
}

}  // namespace tautline::experiments
