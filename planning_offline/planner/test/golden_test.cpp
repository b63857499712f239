/// The values of an independent reference implementation (golden/*.json).

#include <fstream>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "planning_offline/planner/additive_cost.h"
#include "planning_offline/planner/test/planner_test_kit.h"

namespace tautline::planning {
namespace {

using nlohmann::json;
using testing::emptyWorld;
using testing::planTo;
using testing::SmallWorld;

constexpr double kTolerance = 1e-9;

json load(const std::string& name) {
  const std::string file = TAUTLINE_SOURCE_DIR "/planning_offline/planner/test/golden/" + name;
  std::ifstream in(file);
  return json::parse(in);
}

/// Cells (i, j) lie in the zx plane, (i, j, k) in space.
CellIndex cellOf(const GridShape& shape, const json& at) {
  const int i = at[0].get<int>();
  const int j = at[1].get<int>();
  return shape.index(at.size() == 2 ? Eigen::Vector3i(i, 0, j)
                                    : Eigen::Vector3i(i, j, at[2].get<int>()));
}

SmallWorld worldOf(const json& c) {
  const GridShape shape =
      c.contains("shape")
          ? GridShape{c["shape"][0].get<int>(), c["shape"][1].get<int>(), c["shape"][2].get<int>()}
          : GridShape{c["nx"].get<int>(), 1, c["ny"].get<int>()};
  const int neighbours = c["connectivity"].get<int>();
  SmallWorld world = emptyWorld(
      shape, neighbours == 4 || neighbours == 6 ? Connectivity::kFaces : Connectivity::kVertices);
  for (const json& cell : c["occupied"]) {
    world.map->cells[static_cast<std::size_t>(cellOf(shape, cell))] = CellState::kOccupied;
  }
  world.start = cellOf(shape, c["start"]);
  MapLayer first{"terrain_stability", std::vector<double>(shape.size(), 0.0)};
  MapLayer second{"surface", std::vector<double>(shape.size(), 0.0)};
  for (const json& entry : c["locale"]) {
    const auto cell = static_cast<std::size_t>(cellOf(shape, entry["cell"]));
    const json& r = entry["r"];
    first.values[cell] = r[0].get<double>();
    if (r.size() > 1) second.values[cell] = r[1].get<double>();
  }
  world.map->layers = {first, second};

  const std::map<std::string, TurnLaw> laws{{"linear", TurnLaw::kLinear},
                                            {"quad", TurnLaw::kQuadratic},
                                            {"const", TurnLaw::kConstant},
                                            {"threshold", TurnLaw::kThreshold}};
  RiskParams& p = world.params;
  p.cap = c["cap"].get<double>();
  p.terrain_stability.scale = p.surface.scale = 1.0;
  p.action_length.per_metre = c["k_len"].get<double>();
  p.turn = {.law = laws.at(c["turn_model"].get<std::string>()), .risk = c["k_turn"].get<double>()};
  p.tether_length.per_metre = c.value("k_tl", 0.0);
  p.contacts.each = c.value("k_tc", 0.0);
  world.tethered = p.tether_length.per_metre > 0.0 || p.contacts.each > 0.0;
  world.build();
  return world;
}

class Golden : public ::testing::TestWithParam<const char*> {};

TEST_P(Golden, AllPlannersHaveItsRisks) {
  const json file = load(GetParam());
  int goals = 0;
  for (const json& c : file["cases"]) {
    const SmallWorld world = worldOf(c);
    const AdditivePaths additive = additivePaths(
        *world.lattice, additiveCosts(*world.lattice, *world.risk, AdditiveWeights::kPlain),
        world.start, [] { return false; });
    for (const json& g : c["goals"]) {
      const CellIndex goal = cellOf(world.map->shape, g["goal"]);
      SCOPED_TRACE(c["id"].get<std::string>() + " goal " + g["goal"].dump());
      // Either is left out where it is the same as the other.
      const char* one = g.contains("min_risk_simple") ? "min_risk_simple" : "min_risk_walk";
      const double simple = g[one].get<double>();
      const double walk = g.value("min_risk_walk", simple);
      EXPECT_NEAR(planTo(*makeExact(), world, goal).report.risk, simple, kTolerance);
      EXPECT_NEAR(planTo(*makeTether(), world, goal).report.risk, walk, kTolerance);
      EXPECT_NEAR(planTo(*makeDirectional(), world, goal).report.risk,
                  g["directional_risk"].get<double>(), kTolerance);
      if (g.contains("conventional_additive_cost")) {
        EXPECT_NEAR(additive.cost[static_cast<std::size_t>(goal)],
                    g["conventional_additive_cost"].get<double>(), kTolerance);
      }
      ++goals;
    }
  }
  EXPECT_GT(goals, 50);
}

INSTANTIATE_TEST_SUITE_P(Files, Golden,
                         ::testing::Values("planner_small.json", "planner_small_3d.json"));

json caseNamed(const std::string& id) {
  const json file = load("planner_small.json");
  for (const json& c : file["cases"]) {
    if (c["id"] == id) return c;
  }
  return {};
}

TEST(DirectionalMustFailOnTraverseRisk, OfTheTether) {
  for (const char* id : {"directional_fails_3", "directional_fails_6"}) {
    const json c = caseNamed(id);
    const SmallWorld world = worldOf(c);
    const json& g = c["goals"][0];
    const CellIndex goal = cellOf(world.map->shape, g["goal"]);
    const PlanResult directional = planTo(*makeDirectional(), world, goal);
    const PlanResult tether = planTo(*makeTether(), world, goal);
    EXPECT_EQ(directional.status, PlanStatus::kFeasible);
    EXPECT_EQ(tether.status, PlanStatus::kOptimal);
    EXPECT_GT(directional.report.risk, tether.report.risk + 0.02);
    EXPECT_NEAR(tether.report.risk, g["min_risk_walk"].get<double>(), kTolerance);
    EXPECT_LE(*directional.risk_lower_bound, tether.report.risk);
  }
}

TEST(WalksAndSimplePaths, AWalkBeatsEverySimplePath) {
  const json c = caseNamed("walk_beats_simple");
  const SmallWorld world = worldOf(c);
  const CellIndex goal = cellOf(world.map->shape, c["goals"][0]["goal"]);
  const PlanResult directional = planTo(*makeDirectional(), world, goal);
  const PlanResult exact = planTo(*makeExact(), world, goal);
  EXPECT_FALSE(directional.simple);
  EXPECT_TRUE(exact.simple);
  EXPECT_NEAR(directional.report.risk, c["goals"][0]["min_risk_walk"].get<double>(), kTolerance);
  EXPECT_NEAR(exact.report.risk, c["goals"][0]["min_risk_simple"].get<double>(), kTolerance);
  EXPECT_LT(directional.report.risk, exact.report.risk);
}

}  // namespace
}  // namespace tautline::planning
