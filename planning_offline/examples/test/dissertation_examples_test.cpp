/// @file
/// The published numbers of the dissertation's examples, planned on the shipped maps with the
/// shipped parameters (docs/dissertation_examples.md).

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "planning_offline/examples/test/example.h"
#include "planning_offline/examples/test/shipped_path.h"
#include "planning_offline/risk/table_file.h"

namespace tautline::planning {
namespace {

constexpr double kAngle = 1e-9;  // between unit vectors

std::size_t at(RiskElement element) { return static_cast<std::size_t>(element); }

/// Points where the direction changes.
int turns(const std::vector<Eigen::Vector3d>& path) {
  int count = 0;
  for (std::size_t i = 2; i < path.size(); ++i) {
    const Eigen::Vector3d before = (path[i - 1] - path[i - 2]).normalized();
    const Eigen::Vector3d after = (path[i] - path[i - 1]).normalized();
    if ((after - before).norm() > kAngle) ++count;
  }
  return count;
}

std::size_t mostContacts(const RiskReport& report) {
  std::size_t most = 0;
  for (const StateRisk& state : report.states) most = std::max(most, state.contacts.size());
  return most;
}

double leastDistance(const Example& example, const std::vector<CellIndex>& path) {
  double least = std::numeric_limits<double>::infinity();
  for (const CellIndex cell : path) {
    const float distance = example.risk->fields().distance[static_cast<std::size_t>(cell)];
    least = std::min(least, static_cast<double>(distance));
  }
  return least;
}

std::vector<std::vector<double>> published(const std::string& name) {
  return readRiskTable(std::string(TAUTLINE_SOURCE_DIR) + "/config/risk/tables/" + name + ".toml");
}

// ---- chapter 3: twelve states -----------------------------------------------------------------

TEST(WorkedExample, EveryStateIsFinishedWithThePublishedProbability) {
  const Example example =
      loadExample("scenes/dissertation/worked_example.scene.toml",
                  "risk/dissertation_worked_example.toml", Connectivity::kVertices);
  const RiskReport report =
      example.risk->evaluate(shippedPath("scenes/dissertation/worked_example.path.txt"));
  const std::array<double, 12> finish{0.99, 1.0,  1.0,  0.96, 0.96, 0.98,
                                      0.89, 0.95, 0.97, 0.97, 0.94, 0.93};
  ASSERT_EQ(report.states.size(), finish.size());
  for (std::size_t i = 0; i < finish.size(); ++i) {
    EXPECT_NEAR(1.0 - report.states[i].risk, finish[i], 0.005) << "state " << i;
    EXPECT_EQ(report.states[i].contacts.size(), i < 6 ? 0U : 1U) << "state " << i;
  }
  EXPECT_NEAR(report.risk, 0.38, 0.005);
}

TEST(WorkedExample, TheStateBelowTheObstacleHasItsThreePublishedElements) {
  const Example example =
      loadExample("scenes/dissertation/worked_example.scene.toml",
                  "risk/dissertation_worked_example.toml", Connectivity::kVertices);
  const RiskReport report =
      example.risk->evaluate(shippedPath("scenes/dissertation/worked_example.path.txt"));
  const StateRisk& s_75 = report.states.at(6);
  EXPECT_NEAR(s_75.elements[at(RiskElement::kDistance)], 0.04, 0.005);
  EXPECT_NEAR(s_75.elements[at(RiskElement::kTurn)], 0.04, 0.005);
  EXPECT_NEAR(s_75.elements[at(RiskElement::kContacts)], 0.03, 1e-12);
  ASSERT_EQ(s_75.contacts.size(), 1U);  // at the obstacle's lower left corner
  EXPECT_NEAR((s_75.contacts[0] - Eigen::Vector3d(2.3, 0.05, 3.7)).norm(), 0.0, 1e-6);
}

// ---- chapter 4: no optimal substructure -------------------------------------------------------

TEST(ToyExample, TheBestPathToTheCornerPassesItsNeighbourOffTheNeighboursBestPath) {
  const Example example = loadExample("scenes/dissertation/toy_3x3.map",
                                      "risk/dissertation_toy.toml", Connectivity::kFaces);
  const CellIndex upper_middle = example.cellAt({1.5, 0.5, 0.5});
  const CellIndex upper_left = example.cellAt({0.5, 0.5, 0.5});
  const PlanProblem problem = example.problem(Eigen::Vector3d(0.5, 0.5, 2.5));
  PlanOptions options;
  for (const char* planner : {"directional", "exact"}) {
    options.goal = upper_middle;
    const PlanResult to_middle = solve(planner, problem, options, Progress{});
    options.goal = upper_left;
    const PlanResult to_left = solve(planner, problem, options, Progress{});
    ASSERT_EQ(to_left.path.size(), 7U) << planner;  // along the right-hand side
    EXPECT_EQ(to_middle.path.size(), 4U) << planner;
    std::vector<CellIndex> part = to_left.path;
    part.pop_back();
    ASSERT_EQ(part.back(), upper_middle);
    EXPECT_GT(example.risk->evaluate(part).risk, to_middle.report.risk + 0.01);
    std::vector<CellIndex> longer = to_middle.path;
    longer.push_back(upper_left);
    EXPECT_GT(example.risk->evaluate(longer).risk, to_left.report.risk + 0.01);
  }
}

// ---- chapter 4: squeeze and around ------------------------------------------------------------

TEST(SqueezeAround, TheProposedPlannerSqueezesThroughAndTheConventionalOneGoesAround) {
  const Example example = loadExample("scenes/dissertation/squeeze_around.scene.toml",
                                      "risk/dissertation_squeeze.toml", Connectivity::kVertices);
  const Eigen::Vector3d goal(6.6, 0.2, 3.8);
  const CellIndex passage = example.cellAt({3.4, 0.2, 3.8});
  const auto through = [&](const PlanResult& result) {
    return std::count(result.path.begin(), result.path.end(), passage) == 1;
  };
  for (const char* planner : {"directional", "tether"}) {
    const PlanResult squeeze = example.planTo(planner, goal);
    EXPECT_TRUE(through(squeeze)) << planner;
    EXPECT_NEAR(squeeze.report.risk, 0.14, 0.01) << planner;
    EXPECT_EQ(mostContacts(squeeze.report), 0U) << planner;
  }
  const PlanResult around = example.planTo("additive", goal);
  EXPECT_FALSE(through(around));
  EXPECT_NEAR(around.report.risk, 0.31, 0.01);
  EXPECT_GT(mostContacts(around.report), 0U);
  EXPECT_EQ(example.risk->enabled().size(), 6U);
}

// ---- chapter 4: utility -----------------------------------------------------------------------

TEST(ExactApproximate, AnExtraTurnForMoreRewardIsWorthItButTwoStagesNeglectIt) {
  const Example example = loadExample("scenes/dissertation/exact_approximate.scene.toml",
                                      "risk/dissertation_approximate.toml", Connectivity::kFaces);
  const PlanProblem problem = example.problem();
  const PlanResult exact = solve("exact", problem, {}, Progress{});
  const PlanResult two_stage = solve("utility two-stage", problem, {}, Progress{});
  const PlanResult utility = solve("utility", problem, {}, Progress{});
  ASSERT_TRUE(exact && two_stage && utility);
  EXPECT_EQ(exact.path.back(), two_stage.path.back());
  EXPECT_EQ(exact.path.size(), two_stage.path.size());
  EXPECT_EQ(turns(pointsOf(example, exact.path)), turns(pointsOf(example, two_stage.path)) + 1);
  EXPECT_GT(exact.report.risk, two_stage.report.risk);
  EXPECT_GT(exact.utility, 1.5 * two_stage.utility);
  EXPECT_EQ(utility.path, exact.path);
}

TEST(ThreeObstacles, TheBestViewpointIsNotWorthTheNarrowPassage) {
  const Example example =
      loadExample("scenes/dissertation/three_obstacles.scene.toml",
                  "risk/dissertation_approximate.toml", Connectivity::kVertices);
  const PlanProblem problem = example.problem();
  const auto best =
      std::max_element(example.map->rewards.begin(), example.map->rewards.end(),
                       [](const Reward& a, const Reward& b) { return a.value < b.value; });
  const PlanResult chosen = solve("utility two-stage", problem, {}, Progress{});
  const PlanResult to_best = example.planTo("directional", best->position);
  ASSERT_TRUE(chosen && to_best);
  EXPECT_EQ(std::count(chosen.path.begin(), chosen.path.end(), to_best.path.back()), 0);
  EXPECT_GT(chosen.utility, 1.3 * to_best.utility);
  EXPECT_LT(chosen.report.risk, to_best.report.risk);
  EXPECT_EQ(mostContacts(chosen.report), 0U);
  EXPECT_GT(mostContacts(to_best.report), 0U);
  EXPECT_GT(leastDistance(example, chosen.path), 2.0 * leastDistance(example, to_best.path));
  PlanOptions capped;
  capped.risk_cap = 0.55;
  capped.time_limit = 1e6;
  const PlanResult utility = solve("utility", problem, capped, Progress{});
  EXPECT_EQ(utility.status, PlanStatus::kOptimal) << utility.text;
  EXPECT_EQ(utility.path, chosen.path);
}

// ---- chapter 7: the staircase -----------------------------------------------------------------

struct Viewpoint {
  const char* table;
  double reward;
  double risk;
  double utility;
};
constexpr std::array<Viewpoint, 2> kViewpoints{
    {{"red_path", 1.0, 0.714, 1.401}, {"green_path", 0.9, 0.575, 1.565}}};
constexpr std::array<RiskElement, 6> kColumns{RiskElement::kDistance,     RiskElement::kVisibility,
                                              RiskElement::kActionLength, RiskElement::kTurn,
                                              RiskElement::kTetherLength, RiskElement::kContacts};

Example staircase() {
  return loadExample("scenes/dissertation/staircase.scene.toml", "risk/dissertation.toml",
                     Connectivity::kVertices);
}

Eigen::Vector3d positionOf(const Example& example, double reward) {
  for (const Reward& r : example.map->rewards) {
    if (std::abs(r.value - reward) < 1e-9) return r.position;
  }
  ADD_FAILURE() << "no reward " << reward;
  return Eigen::Vector3d::Zero();
}

TEST(Staircase, LeastRiskPathsHaveThePublishedTables) {
  const Example example = staircase();
  for (const Viewpoint& view : kViewpoints) {
    const std::vector<std::vector<double>> table = published(view.table);
    for (const char* planner : {"directional", "tether"}) {
      SCOPED_TRACE(std::string(view.table) + " by " + planner);
      const PlanResult result = example.planTo(planner, positionOf(example, view.reward));
      ASSERT_EQ(result.path.size(), table.size());
      for (std::size_t i = 0; i < table.size(); ++i) {
        for (std::size_t k = 0; k < kColumns.size(); ++k) {
          EXPECT_NEAR(result.report.states[i].elements[at(kColumns[k])], table[i][k], 1e-9)
              << "state " << i << ", " << nameOf(kColumns[k], kRiskElementNames);
        }
      }
      EXPECT_NEAR(result.report.risk, view.risk, 0.001);
      EXPECT_NEAR(result.utility, view.utility, 0.002);
      EXPECT_EQ(mostContacts(result.report), 0U);
      EXPECT_TRUE(result.simple);
    }
  }
  EXPECT_EQ(example.risk->enabled().size(), kColumns.size());
}

TEST(Staircase, TheSecondBestViewpointHasTheGreaterUtility) {
  const Example example = staircase();
  const CellIndex green = example.cellAt(positionOf(example, 0.9));
  const PlanResult two_stage = solve("utility two-stage", example.problem(), {}, Progress{});
  ASSERT_TRUE(two_stage);
  EXPECT_EQ(two_stage.path.back(), green);
  EXPECT_NEAR(two_stage.utility, 1.565, 0.002);
}

/// Ties would leave the published path to chance: no other least-risk path is as good. Each cell of
/// the path but its ends, forbidden in turn, makes the least risk larger.
TEST(Staircase, ThePublishedPathsAreTheOnlyOnesOfLeastRisk) {
  const Example example = staircase();
  for (const Viewpoint& view : kViewpoints) {
    const PlanResult best = example.planTo("tether", positionOf(example, view.reward));
    ASSERT_TRUE(best);
    for (std::size_t i = 1; i + 1 < best.path.size(); ++i) {
      std::vector<std::uint8_t> free(example.lattice->freeCells().begin(),
                                     example.lattice->freeCells().end());
      free[static_cast<std::size_t>(best.path[i])] = 0;
      const Lattice without(example.map->shape, Connectivity::kVertices, free);
      PlanProblem problem = example.problem();
      problem.lattice = &without;
      PlanOptions options;
      options.goal = best.path.back();
      const PlanResult other = solve("tether", problem, options, Progress{});
      EXPECT_GT(other.report.cost, best.report.cost + 1e-6) << view.table << ", state " << i;
    }
  }
}

TEST(Staircase, TheMapIsMostlyOpenSpace) {
  const Example example = staircase();
  EXPECT_DOUBLE_EQ(example.map->resolution, 0.4);
  EXPECT_TRUE(example.map->layers.empty());
  EXPECT_GT(2 * example.lattice->freeCount(), example.map->shape.size());
}

}  // namespace
}  // namespace tautline::planning
