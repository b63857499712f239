/// @file
/// The staircase with the planner that proves its utility, not only compares least-risk paths.

#include <gtest/gtest.h>

#include "planning_offline/examples/test/example.h"

namespace tautline::planning {
namespace {

TEST(StaircaseUtility, NoPathThatVisitsOneViewpointIsBetterThanTheGreenOne) {
  const Example example = loadExample("scenes/dissertation/staircase.scene.toml",
                                      "risk/dissertation.toml", Connectivity::kVertices);
  const PlanResult two_stage = solve("utility two-stage", example.problem(), {}, Progress{});
  // Without a cap the ratio is best on a tour of both viewpoints.
  PlanOptions one_of_them;
  one_of_them.risk_cap = 0.75;
  one_of_them.time_limit = 1e6;
  const PlanResult utility = solve("utility", example.problem(), one_of_them, Progress{});
  EXPECT_EQ(utility.status, PlanStatus::kOptimal) << utility.text;
  EXPECT_EQ(utility.path, two_stage.path);
  EXPECT_NEAR(utility.utility, 1.565, 0.002);
}

}  // namespace
}  // namespace tautline::planning
