#include "planning_offline/scenario/scenario.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/toml/toml_file.h"
#include "planning_offline/map/lattice.h"
#include "planning_offline/map/line_reader.h"
#include "planning_offline/scenario/shortest_path.h"

namespace tautline::planning {
namespace {

/// Lengths of 2-D scenarios were added up in single precision.
constexpr double kSinglePrecision = 1.2e-7;

using Words = std::vector<std::string_view>;

/// One unit of the last decimal that was printed.
double lastDecimal(std::string_view number) {
  const std::size_t point = number.find('.');
  const std::size_t decimals = point == std::string_view::npos ? 0 : number.size() - point - 1;
  return std::pow(10.0, -static_cast<double>(decimals));
}

int integerAt(const LineReader& lines, const Words& words, std::size_t i) {
  const std::optional<int> value = integerOf(words[i]);
  if (!value || *value < 0)
    throw lines.error("number " + std::to_string(i + 1) + " is " + shownText(words[i]),
                      "an integer of at least 0");
  return *value;
}

void readLength(const LineReader& lines, std::string_view word, Scenario& row) {
  const std::optional<double> value = numberOf(word);
  if (!value || *value < 0.0)
    throw lines.error("the length is " + shownText(word), "a number of at least 0");
  row.length = *value;
  row.tolerance = lastDecimal(word);
}

Scenario readSpaceRow(const LineReader& lines, const Words& words) {
  if (words.size() != 8) {
    throw lines.error("has " + std::to_string(words.size()) + " words",
                      "sx sy sz gx gy gz length ratio");
  }
  Scenario row{.line = lines.number()};
  for (std::size_t i = 0; i < 3; ++i) {
    row.start[static_cast<int>(i)] = integerAt(lines, words, i);
    row.goal[static_cast<int>(i)] = integerAt(lines, words, i + 3);
  }
  readLength(lines, words[6], row);
  if (!numberOf(words[7])) throw lines.error("the ratio is " + shownText(words[7]), "a number");
  return row;
}

Scenario readPlaneRow(const LineReader& lines, const Words& words, ScenarioFile& scenarios) {
  if (words.size() != 9) {
    throw lines.error("has " + std::to_string(words.size()) + " words",
                      "bucket map width height sx sy gx gy length");
  }
  (void)integerAt(lines, words, 0);
  const GridShape shape{integerAt(lines, words, 2), 1, integerAt(lines, words, 3)};
  if (scenarios.rows.empty()) {
    scenarios.map = words[1];
    scenarios.shape = shape;
  } else if (scenarios.map != words[1] || !(scenarios.shape == shape)) {
    throw lines.error("is about map " + shownText(words[1]) + " with " + std::to_string(shape.nx) +
                          " x " + std::to_string(shape.nz) + " cells",
                      shownText(scenarios.map) + " with " + std::to_string(scenarios.shape.nx) +
                          " x " + std::to_string(scenarios.shape.nz) + ", as in the first row");
  }
  Scenario row{.line = lines.number()};
  row.start = {integerAt(lines, words, 4), 0, integerAt(lines, words, 5)};
  row.goal = {integerAt(lines, words, 6), 0, integerAt(lines, words, 7)};
  readLength(lines, words[8], row);
  row.tolerance += kSinglePrecision * row.length;
  return row;
}

InputError otherMap(const ScenarioFile& scenarios, int line, std::string problem) {
  return InputError({.file = scenarios.file,
                     .line = line,
                     .problem = std::move(problem),
                     .remedy = "give the whole map " + shownText(scenarios.map)});
}

std::string textOf(const GridShape& shape) {
  return std::to_string(shape.nx) + " x " + std::to_string(shape.ny) + " x " +
         std::to_string(shape.nz);
}

void checkSameMap(const VoxelMap& map, const ScenarioFile& scenarios) {
  if (scenarios.planar && !(map.shape == scenarios.shape)) {
    throw otherMap(
        scenarios, 0,
        "is for a map of " + textOf(scenarios.shape) + " cells; this one has " + textOf(map.shape));
  }
  if (!scenarios.planar && map.shape.planar())
    throw otherMap(scenarios, 0, "is for a map of space; this one is planar");
  if (!map.origin.isZero())
    throw otherMap(scenarios, 0, "counts cells from the map's corner; this one is cropped");
  for (const Scenario& row : scenarios.rows) {
    if (!map.shape.contains(row.start) || !map.shape.contains(row.goal)) {
      throw otherMap(scenarios, row.line,
                     "start or goal is outside the map of " + textOf(map.shape) + " cells");
    }
  }
}

}  // namespace

ScenarioFile readScenarios(const std::filesystem::path& path) {
  return parseScenarios(readTextFile(path), path.string());
}

ScenarioFile parseScenarios(std::string_view text, const std::string& name) {
  ScenarioFile scenarios{.file = name};
  LineReader lines(name, text);
  lines.nextNotBlank();
  const Words version = lines.words();
  if (version.size() != 2 || version[0] != "version" || numberOf(version[1]) != 1.0)
    throw lines.error("starts with " + shownText(lines.line()), "version 1");
  if (!lines.nextNotBlank()) throw lines.error("the file ends after its version");
  // A map's name alone on its line is what only 3-D files have.
  scenarios.planar = lines.words().size() != 1;
  if (!scenarios.planar) {
    scenarios.map = lines.words()[0];
    if (!lines.nextNotBlank()) throw lines.error("there are no scenarios");
  }
  do {
    const Words words = lines.words();
    scenarios.rows.push_back(scenarios.planar ? readPlaneRow(lines, words, scenarios)
                                              : readSpaceRow(lines, words));
  } while (lines.nextNotBlank());
  return scenarios;
}

ScenarioReport checkScenarios(const VoxelMap& map, const ScenarioFile& scenarios,
                              const Progress& progress) {
  checkSameMap(map, scenarios);
  std::vector<std::uint8_t> free(map.cells.size());
  std::transform(map.cells.begin(), map.cells.end(), free.begin(),
                 [](CellState s) { return s == CellState::kFree ? 1 : 0; });
  const Lattice lattice(map.shape, Connectivity::kVertices, std::move(free));
  ShortestPath search(lattice);
  ScenarioReport report;
  for (const Scenario& row : scenarios.rows) {
    progress.report("scenarios", static_cast<double>(report.rows.size()) /
                                     static_cast<double>(scenarios.rows.size()));
    ScenarioResult result{.scenario = row};
    result.found = search.length(map.shape.index(row.start), map.shape.index(row.goal), progress);
    if (progress.cancelled()) {
      report.cancelled = true;
      break;
    }
    result.equal = result.found && std::abs(*result.found - row.length) <= row.tolerance;
    report.mismatches += result.equal ? 0U : 1U;
    report.rows.push_back(result);
  }
  return report;
}

}  // namespace tautline::planning
