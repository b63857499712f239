#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/fields.h"
#include "planning_offline/risk/risk_model.h"
#include "planning_offline/risk/test/test_world.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {
namespace {

using nlohmann::json;

const std::filesystem::path kGolden =
    TAUTLINE_SOURCE_DIR "/planning_offline/risk/test/golden/planner_small.json";

/// Cell (i, j) of the file: i along x, j along z.
Eigen::Vector3i cellOf(const json& c) {
  const auto v = c.get<std::vector<int>>();
  return {v.at(0), 0, v.at(1)};
}

/// Locale risks as layers with scale 1; lengths in cells.
VoxelMap mapOf(const json& c) {
  VoxelMap map = emptyMap({c.at("nx").get<int>(), 1, c.at("ny").get<int>()}, 1.0);
  for (const json& cell : c.at("occupied"))
    map.cells[static_cast<std::size_t>(map.shape.index(cellOf(cell)))] = CellState::kOccupied;
  for (const char* name : {"terrain_stability", "surface"})
    map.layers.push_back({name, std::vector<double>(map.shape.size(), 0.0)});
  for (const json& state : c.at("locale")) {
    const auto r = state.at("r").get<std::vector<double>>();
    const auto i = static_cast<std::size_t>(map.shape.index(cellOf(state.at("cell"))));
    for (std::size_t k = 0; k < r.size(); ++k) map.layers.at(k).values[i] = r[k];
  }
  return map;
}

RiskParams paramsOf(const json& c) {
  RiskParams params = nothingOn();
  params.cap = c.at("cap").get<double>();
  params.terrain_stability.scale = params.surface.scale = 1.0;
  params.action_length.per_metre = c.at("k_len").get<double>();
  const auto law = c.at("turn_model").get<std::string>();
  params.turn.law = law == "linear"  ? TurnLaw::kLinear
                    : law == "quad"  ? TurnLaw::kQuadratic
                    : law == "const" ? TurnLaw::kConstant
                                     : TurnLaw::kThreshold;
  params.turn.risk = c.at("k_turn").get<double>();
  params.turn.gentle_cosine = 0.7;
  params.turn.sharp_factor = 12.0;
  params.tether_length.per_metre = c.at("k_tl").get<double>();
  params.contacts.each = c.at("k_tc").get<double>();
  return params;
}

std::vector<CellIndex> pathOf(const VoxelMap& map, const json& cells) {
  std::vector<CellIndex> path;
  for (const json& cell : cells) path.push_back(map.shape.index(cellOf(cell)));
  return path;
}

TEST(Golden, RisksOfPaths) {
  struct Pair {
    const char* path;
    const char* risk;
  };
  constexpr Pair kPairs[] = {{"an_optimal_path", "min_risk_walk"},
                             {"an_optimal_walk", "min_risk_walk"},
                             {"an_optimal_simple_path", "min_risk_simple"},
                             {"directional_path", "directional_risk"}};
  int checked = 0;
  const json file = json::parse(std::ifstream(kGolden));
  for (const json& c : file.at("cases")) {
    const VoxelMap map = mapOf(c);
    const RiskParams params = paramsOf(c);
    std::shared_ptr<TautString> string;
    if (isOn(params, RiskElement::kContacts))
      string = makeTautString(map, map.centre(map.shape.index(cellOf(c.at("start")))));
    const RiskModel model = modelOf(map, {}, params, string);
    for (const json& goal : c.at("goals")) {
      for (const Pair& pair : kPairs) {
        if (!goal.contains(pair.path)) continue;
        const RiskReport report = model.evaluate(pathOf(map, goal.at(pair.path)));
        EXPECT_NEAR(report.risk, goal.at(pair.risk).get<double>(), 1e-9)
            << c.at("id") << ' ' << pair.path << " to " << goal.at("goal");
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 100);
}

}  // namespace
}  // namespace tautline::planning
