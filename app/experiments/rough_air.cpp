#include "app/experiments/rough_air.h"

#include <array>
#include <map>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "app/experiments/localization.h"
#include "app/experiments/path1.h"
#include "app/experiments/path2.h"
#include "app/experiments/staircase_paths.h"
#include "app/experiments/tether_planning.h"
#include "common/toml/config_file.h"
#include "common/toml/toml_file.h"

namespace tautline::experiments {
namespace {

/// The staircase is not among them: its trials are other flights.
const std::array kParts{&kLocalization, &kPath1, &kPath2, &kTetherPlanning};

constexpr const char* kTooRough =
    "air as rough as the shares of the staircase ask for is too rough for this";

std::int64_t flightsOf(const Setup& setup) { return setup.quick ? 20 : 1000; }

/// The set-up with what rough_air.toml has otherwise.
std::shared_ptr<const Setup> inRoughAir(const Setup& setup) {
  const auto rough = std::make_shared<Setup>(setup);
  ConfigReader::readStruct(TomlFile::load(setup.folder / "rough_air.toml").root(), rough->plant);
  tellPull(rough->tautline, rough->plant.vehicle.tension);
  return rough;
}

std::string partTrial(const Experiment& part, const std::string& trial) {
  return fmt::format("{} {}", part.name, trial);
}

std::vector<Trial> trials(const Setup& setup) {
  const std::shared_ptr<const Setup> rough = inRoughAir(setup);
  std::vector<Trial> all;
  for (const Experiment* part : kParts) {
    for (Trial& trial : part->trials(*rough)) {
      // The part's trials refer to its set-up.
      all.push_back(
          {partTrial(*part, trial.name), [rough, run = std::move(trial.run)] { return run(); }});
    }
  }
  for (Trial& trial : stairTrials(*rough, planStairs(*rough), flightsOf(setup)))
    all.push_back(std::move(trial));
  return all;
}

/// What the part makes of its own trials among `results`.
Findings judgePart(const Experiment& part, const Setup& rough, const Results& results) {
  std::map<std::string, nlohmann::json> own;
  for (const Trial& trial : part.trials(rough))
    own.emplace(trial.name, results.at(partTrial(part, trial.name)));
  return part.judge(rough, Results(std::move(own)));
}

/// Rows of what was published. Ours is told: its goals are judged in the air of plant.toml.
Findings judge(const Setup& setup, const Results& results) {
  const std::shared_ptr<const Setup> rough = inRoughAir(setup);
  Findings findings;
  for (const Experiment* part : kParts) {
    for (Row& row : judgePart(*part, *rough, results).rows) {
      if (!row.as_published_band) continue;
      row.figure = fmt::format("{}: {}", part->name, row.figure);
      row.tautline_band.reset();
      row.shortfall = kTooRough;
      findings.rows.push_back(std::move(row));
    }
  }
  const StairTallies tallies = stairTallies(results, flightsOf(setup));
  for (std::size_t v = 0; v < kViewpoints.size(); ++v) {
    Row success = successRow(kViewpoints[v], tallies[0][v], tallies[1][v]);
    success.figure.insert(0, "staircase: ");
    if (setup.quick) success.as_published_band.reset();  // so few tell nothing of a share of 0.04
    findings.rows.push_back(std::move(success));
  }
  return findings;
}

}  // namespace

const Experiment kRoughAir{
    "rough_air", "Rougher air: the shares of the staircase",
    "Hovers, both paths, tether contacts and the staircase again, by a machine that pulls with "
    "0.32 N in gusts of 0.5 m/s which last 6 s (rough_air.toml): air as rough as the dissertation "
    "says that its propellers made it. Only the published side is judged.",
    trials, judge};

}  // namespace tautline::experiments
