#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.h"
#include "planning_offline/planner/test/planner_test_kit.h"

namespace tautline::planning {
namespace {

using testing::emptyWorld;
using testing::problemOf;
using testing::SmallWorld;

SmallWorld room() {
  SmallWorld world = emptyWorld({5, 1, 5}, Connectivity::kEdges);
  world.map->cells[6] = CellState::kOccupied;
  world.build();
  return world;
}

PlanOptions to(CellIndex goal) {
  PlanOptions options;
  options.goal = goal;
  return options;
}

std::string messageOf(std::string_view planner, const PlanProblem& problem,
                      const PlanOptions& options) {
  try {
    (void)solve(planner, problem, options, Progress());
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Registry, HasEachPlannerOnceAndEachCanBeMade) {
  std::vector<std::string> names;
  for (const PlannerInfo& info : planners()) {
    names.emplace_back(info.name);
    EXPECT_NE(info.make(), nullptr) << info.name;
    EXPECT_NE(std::string(info.optimal_for), "");
  }
  EXPECT_EQ(names.size(), 8U);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST(Registry, LeastRiskPlannersAgreeAndAreTimed) {
  const SmallWorld world = room();
  const PlanProblem problem = problemOf(world);
  const PlanResult tether = solve("tether", problem, to(24), Progress());
  EXPECT_GE(tether.seconds, 0.0);
  for (const char* name : {"exact", "directional", "lookback"}) {
    EXPECT_NEAR(solve(name, problem, to(24), Progress()).report.cost, tether.report.cost, 1e-12);
  }
}

TEST(Registry, SaysWhatIsWrong) {
  const SmallWorld world = room();
  PlanProblem problem = problemOf(world);
  EXPECT_THAT(messageOf("best", problem, to(24)), ::testing::HasSubstr("directional"));
  EXPECT_THAT(messageOf("tether", problem, to(6)), ::testing::HasSubstr("goal: is not free"));
  EXPECT_THAT(messageOf("tether", problem, to(25)), ::testing::HasSubstr("outside the map"));
  EXPECT_THAT(messageOf("tether", problem, {}), ::testing::HasSubstr("neither a goal nor rewards"));
  PlanOptions options = to(24);
  options.risk_cap = 1.5;
  EXPECT_THAT(messageOf("tether", problem, options), ::testing::HasSubstr("risk_cap"));
  options = to(24);
  options.lookback = 5;
  EXPECT_THAT(messageOf("lookback", problem, options), ::testing::HasSubstr("lookback"));
  options = to(24);
  options.discount = -0.1;
  EXPECT_THAT(messageOf("exact", problem, options), ::testing::HasSubstr("discount"));
  problem.start = 6;
  EXPECT_THAT(messageOf("tether", problem, to(24)), ::testing::HasSubstr("start: is not free"));
}

}  // namespace
}  // namespace tautline::planning
