#include "app/experiments/setup.h"

#include <algorithm>
#include <vector>

#include "common/mission/mission_file.h"
#include "common/toml/config_file.h"
#include "common/toml/toml_file.h"

namespace tautline::experiments {

std::string Setup::fingerprint() const {
  namespace fs = std::filesystem;
  std::string text = readTextFile("/proc/self/exe");
  // Scenes, missions and risk parameters stand beside the set-up's own files.
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(fs::weakly_canonical(folder / "..")))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) text += file.filename().string() + readTextFile(file);
  text += (quick ? "quick " : "whole ") + std::to_string(seed);
  return hashText(fnv1a(text));
}

StationConfig demonstrationStation(const Setup& setup, std::size_t station) {
  if (station != 0) return setup.tautline;
  StationConfig published = setup.as_published;
  published.core.localizer.variant = LocalizerVariant::kAsPublishedCode;
  published.core.control.law = Law::kPosition;
  return published;
}

void tellPull(StationConfig& station, double tension) {
  CoreConfig& core = station.core;
  core.localizer.nominal_tension_n = tension;
  core.executor.target.nominal_tension_n = tension;
  core.control.composite.feed_forward.nominal_tension_n = tension;
  core.control.position.target.nominal_tension_n = tension;
}

void pullWith(bench::LockstepConfig& flight, double tension) {
  flight.sim.vehicle.tension = tension;
  tellPull(flight.station, tension);
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
