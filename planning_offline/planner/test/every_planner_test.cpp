/// Rules that all planners of least risk keep.

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "common/error.h"
#include "planning_offline/planner/test/planner_test_kit.h"

namespace tautline::planning {
namespace {

using testing::emptyWorld;
using testing::picture;
using testing::planTo;
using testing::problemOf;
using testing::rewardsAt;
using testing::SmallWorld;

class EveryPlanner : public ::testing::TestWithParam<std::unique_ptr<Planner> (*)()> {
 protected:
  std::unique_ptr<Planner> planner_ = GetParam()();
};

TEST_P(EveryPlanner, StaysWhereItIs) {
  SmallWorld world = picture({"s.."}, Connectivity::kFaces);
  world.params.surface.scale = 0.1;
  world.map->layers[1].values[0] = 1.0;
  world.build();
  const PlanResult result = planTo(*planner_, world, world.start);
  EXPECT_EQ(result.status, PlanStatus::kOptimal);
  EXPECT_EQ(result.path, std::vector<CellIndex>{0});
  EXPECT_NEAR(result.report.risk, 0.1, 1e-15);  // the start counts
  EXPECT_TRUE(result.simple);
}

TEST_P(EveryPlanner, PlansOnAMapOfOneCell) {
  SmallWorld world = emptyWorld({1, 1, 1}, Connectivity::kVertices);
  world.tethered = true;
  world.params.tether_length.per_metre = 0.01;
  world.build();
  const PlanResult result = planTo(*planner_, world, 0);
  EXPECT_EQ(result.path, std::vector<CellIndex>{0});
  EXPECT_EQ(result.report.risk, 0.0);
}

TEST_P(EveryPlanner, SaysThatAGoalIsUnreachable) {
  SmallWorld world = picture({"s.#."}, Connectivity::kEdges);
  world.build();
  const PlanResult result = planTo(*planner_, world, 3);
  EXPECT_EQ(result.status, PlanStatus::kUnreachable);
  EXPECT_FALSE(result);
  EXPECT_FALSE(result.text.empty());
}

TEST_P(EveryPlanner, TakesNoPathAboveTheRiskCap) {
  SmallWorld world = picture({"s......"}, Connectivity::kFaces);
  world.build();
  PlanOptions options;
  options.risk_cap = 0.05;
  EXPECT_EQ(planTo(*planner_, world, 6, options).status, PlanStatus::kUnreachable);
  EXPECT_EQ(planTo(*planner_, world, 2, options).path.size(), 3U);
}

TEST_P(EveryPlanner, NeedsAGoalOrRewards) {
  SmallWorld world = picture({"s."}, Connectivity::kFaces);
  world.build();
  EXPECT_THROW((void)planner_->plan(problemOf(world), {}, Progress()), InputError);
  EXPECT_THROW((void)planner_->plan(problemOf(world, {0.0, 0.0}), {}, Progress()), InputError);
}

TEST_P(EveryPlanner, ChoosesAnEndWhereThereAreRewards) {
  SmallWorld world = picture({"s......"}, Connectivity::kFaces);
  world.build();
  const auto reward = rewardsAt(world, {{5, 1.0}});
  const PlanResult result = planner_->plan(problemOf(world, reward), {}, Progress());
  ASSERT_FALSE(result.path.empty());
  EXPECT_EQ(result.path.back(), 5);
  EXPECT_EQ(result.reward, 1.0);
  EXPECT_NEAR(result.utility, 1.0 / result.report.risk, 1e-12);
}

TEST_P(EveryPlanner, IsTheSameEveryTime) {
  SmallWorld world = emptyWorld({5, 1, 5}, Connectivity::kEdges);  // full of ties
  world.start = 7;
  world.tethered = true;
  world.params.contacts.each = 0.1;
  world.map->cells[12] = CellState::kOccupied;
  world.build();
  for (const CellIndex goal : {0, 18, 24}) {
    const PlanResult one = planTo(*planner_, world, goal);
    const PlanResult two = planTo(*planner_, world, goal);
    EXPECT_EQ(one.path, two.path);
    EXPECT_EQ(one.expanded, two.expanded);
    EXPECT_EQ(one.text, two.text);
  }
}

TEST_P(EveryPlanner, StopsWhenCancelled) {
  SmallWorld world = emptyWorld({40, 1, 40}, Connectivity::kEdges);
  world.tethered = true;
  world.params.contacts.each = 0.1;
  world.build();
  Progress progress;
  progress.cancel();
  PlanOptions options;
  options.goal = 1599;
  const PlanResult result = planner_->plan(problemOf(world), options, progress);
  EXPECT_TRUE(result.status == PlanStatus::kNone || result.status == PlanStatus::kCut);
  EXPECT_NE(result.text.find("cancelled"), std::string::npos) << result.text;
}

std::string nameOfPlanner(const ::testing::TestParamInfo<std::unique_ptr<Planner> (*)()>& test) {
  constexpr std::array kNames{"Exact", "Additive", "Directional", "Lookback", "Tether"};
  return kNames[test.index];
}

INSTANTIATE_TEST_SUITE_P(LeastRisk, EveryPlanner,
                         ::testing::Values(makeExact, makeAdditive, makeDirectional, makeLookback,
                                           makeTether),
                         nameOfPlanner);

}  // namespace
}  // namespace tautline::planning
