#include "control/motion_executor.h"

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace tautline {
namespace {

using std::chrono::milliseconds;

constexpr Duration kStep = milliseconds(100);

Estimate at(const Eigen::Vector3d& p_WD, double sigma = 0.01) {
  Estimate e;
  e.valid = true;
  e.health = EstimateHealth::kOk;
  e.p_WD = p_WD;
  e.P_position = sigma * sigma * Eigen::Matrix3d::Identity();
  e.T = 0.5;
  return e;
}

/// An executor, its plan and a drone that can be put anywhere.
class MotionExecutorTest : public ::testing::Test {
 protected:
  void add(const Eigen::Vector3d& p_WD, int contact = 0, double hold = 0.0, double speed = 0.0) {
    Waypoint& w = plan_->waypoints[static_cast<std::size_t>(plan_->waypoint_count++)];
    w.p_WD = p_WD;
    w.contact = contact;
    w.hold = hold;
    w.speed = speed;
  }

  void addContact(int id, const Eigen::Vector3d& p_WC) {
    plan_->contacts[static_cast<std::size_t>(plan_->contact_count++)] = {.id = id, .p_WC = p_WC};
  }

  MotionExecutor& executor() {
    if (!executor_) {
      executor_ =
          std::make_unique<MotionExecutor>(config_, PoleConfig{}, VehicleLimits{}, contacts_);
    }
    return *executor_;
  }

  ExecutorOutput stepAt(const Eigen::Vector3d& p_WD, int steps = 1) {
    ExecutorOutput out;
    for (int i = 0; i < steps; ++i) out = executor().update(kStep, {.estimate = at(p_WD)});
    return out;
  }

  MissionState state() { return executor().status().state; }
  MissionFailure failure() { return executor().status().failure; }

  std::unique_ptr<MissionPlan> plan_{std::make_unique<MissionPlan>()};
  ExecutorConfig config_;
  ContactStack contacts_;
  std::unique_ptr<MotionExecutor> executor_;
};

TEST_F(MotionExecutorTest, IsIdleUntilStartedAndAfterAbort) {
  EXPECT_EQ(state(), MissionState::kIdle);
  EXPECT_FALSE(stepAt({1, 1, 1}).active);
  EXPECT_FALSE(executor().pause());
  EXPECT_FALSE(executor().resume());
  EXPECT_FALSE(executor().skip());
  EXPECT_FALSE(executor().goBack(FlownPath{}, 1.0, 0.3, at({1, 1, 1})));
  add({2, 1, 1});
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  EXPECT_EQ(state(), MissionState::kRunning);
  EXPECT_TRUE(stepAt({1, 1, 1}).active);
  executor().abort();
  EXPECT_EQ(state(), MissionState::kIdle);
  EXPECT_FALSE(stepAt({1, 1, 1}).active);
}

TEST_F(MotionExecutorTest, DoesNotStartWithoutAPlanOrAnEstimate) {
  EXPECT_FALSE(executor().start(*plan_, at({1, 1, 1})));
  add({2, 1, 1});
  Estimate lost = at({1, 1, 1});
  lost.health = EstimateHealth::kLost;
  EXPECT_FALSE(executor().start(*plan_, lost));
  EXPECT_FALSE(executor().start(*plan_, Estimate{}));
  EXPECT_FALSE(executor().goTo({.p_WD = Eigen::Vector3d::Constant(std::nan(""))}, at({1, 1, 1})));
  EXPECT_EQ(state(), MissionState::kIdle);
}

TEST_F(MotionExecutorTest, FirstSegmentStartsAtTheDroneTheOthersAtTheWaypointBefore) {
  plan_->hash = 77;
  add({2, 1, 1}, 0, 0.0, 0.2);
  add({2, 1, 3});
  ASSERT_TRUE(executor().start(*plan_, at({1, 1.2, 1})));
  ControlInput first = stepAt({1, 1.2, 1}).control;
  EXPECT_EQ(first.p_WS, Eigen::Vector3d(1, 1.2, 1));
  EXPECT_EQ(first.p_WE, Eigen::Vector3d(2, 1, 1));
  EXPECT_EQ(first.p_WN, Eigen::Vector3d(2, 1, 3));
  EXPECT_EQ(first.speed, 0.2);
  const ControlInput second = stepAt({1.9, 1, 1}).control;
  EXPECT_EQ(second.p_WS, Eigen::Vector3d(2, 1, 1));
  EXPECT_EQ(second.p_WE, Eigen::Vector3d(2, 1, 3));
  EXPECT_FALSE(second.p_WN);
  EXPECT_EQ(second.speed, config_.speed_mps);
  const ExecutorStatus& status = executor().status();
  EXPECT_EQ(status.mission_hash, 77U);
  EXPECT_EQ(status.waypoint, 1);
  EXPECT_EQ(status.waypoint_count, 2);
  EXPECT_NEAR(status.distance, std::hypot(0.1, 2.0), 1e-12);
  EXPECT_NEAR(status.cross_track, 0.1, 1e-12);
  const ControlInput done = stepAt({2, 1, 2.95}).control;
  EXPECT_EQ(state(), MissionState::kCompleted);
  EXPECT_EQ(done.p_WS, done.p_WE);
  EXPECT_EQ(done.p_WE, Eigen::Vector3d(2, 1, 3));
}

TEST_F(MotionExecutorTest, HoldsForTheTimeAskedFor) {
  add({2, 1, 1}, 0, 1.0);
  add({3, 1, 1});
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  const ControlInput on_the_way = stepAt({1, 1, 1}).control;
  EXPECT_FALSE(on_the_way.p_WN);  // it stops there
  const ControlInput holding = stepAt({2, 1, 1}).control;
  EXPECT_EQ(state(), MissionState::kHolding);
  EXPECT_EQ(holding.p_WS, holding.p_WE);
  stepAt({2.3, 1, 1}, 9);  // blown away: still holding the waypoint
  EXPECT_EQ(state(), MissionState::kHolding);
  EXPECT_EQ(executor().status().waypoint, 0);
  stepAt({2, 1, 1}, 1);
  EXPECT_EQ(state(), MissionState::kRunning);
  EXPECT_EQ(executor().status().waypoint, 1);
}

TEST_F(MotionExecutorTest, PauseHoldsHereAndResumeGoesOnFromThere) {
  add({2, 1, 1}, 0, 1.0);
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  stepAt({1.3, 1, 1});
  ASSERT_TRUE(executor().pause());
  EXPECT_FALSE(executor().pause());
  const ControlInput paused = stepAt({1.4, 1.1, 1}, 5000).control;  // no time-out while paused
  EXPECT_EQ(state(), MissionState::kPaused);
  EXPECT_EQ(paused.p_WE, Eigen::Vector3d(1.3, 1, 1));
  ASSERT_TRUE(executor().resume());
  EXPECT_FALSE(executor().resume());
  EXPECT_EQ(stepAt({1.4, 1.1, 1}).control.p_WS, Eigen::Vector3d(1.4, 1.1, 1));
  EXPECT_EQ(state(), MissionState::kRunning);

  stepAt({2, 1, 1}, 6);  // arrived, half of the hold over
  ASSERT_EQ(state(), MissionState::kHolding);
  ASSERT_TRUE(executor().pause());
  EXPECT_EQ(stepAt({2.1, 1, 1}, 100).control.p_WE, Eigen::Vector3d(2, 1, 1));
  ASSERT_TRUE(executor().resume());
  EXPECT_EQ(state(), MissionState::kHolding);
  stepAt({2, 1, 1}, 5);
  EXPECT_EQ(state(), MissionState::kCompleted);
}

TEST_F(MotionExecutorTest, SkipGivesUpAWaypointButNeverAContact) {
  addContact(1, {1, 1, 0});
  add({2, 1, 1});
  add({3, 1, 1});
  add({4, 1, 1}, 1);
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  stepAt({1.2, 1, 1});
  ASSERT_TRUE(executor().skip());
  EXPECT_EQ(executor().status().waypoint, 1);
  EXPECT_EQ(stepAt({1.2, 1, 1}).control.p_WS, Eigen::Vector3d(1.2, 1, 1));
  EXPECT_FALSE(executor().skip());  // waypoint 2 is behind the contact
  EXPECT_EQ(executor().status().waypoint, 1);
  stepAt({3, 1, 1});
  EXPECT_EQ(executor().status().waypoint, 2);
  ASSERT_TRUE(executor().pause());
  ASSERT_TRUE(executor().skip());  // the last one
  EXPECT_EQ(state(), MissionState::kCompleted);
  EXPECT_FALSE(executor().skip());
}

TEST_F(MotionExecutorTest, SwitchesTheAnchorWhenAWaypointBecomesTheTarget) {
  addContact(5, {1, 1, 0});
  addContact(9, {2, 1, 0});
  add({2, 1, 2});
  add({3, 1, 2}, 5);
  add({4, 1, 2}, 9);
  add({3, 1, 2}, 5);
  add({2, 1, 2}, 0);
  const std::vector<int> ids{0, 5, 9, 5, 0};
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 2})));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    EXPECT_EQ(contacts_.activeId(), ids[i]);
    const Eigen::Vector3d target = plan_->waypoints[i].p_WD;
    const Eigen::Vector3d short_of = target - Eigen::Vector3d(i < 3 ? 0.5 : -0.5, 0, 0);
    const ExecutorOutput out = stepAt(short_of);
    EXPECT_EQ(out.control.anchor.contact_count, contacts_.contactCount());
    const EffectiveControls want = contacts_.effective(target);
    EXPECT_DOUBLE_EQ(executor().status().target_length, want.L_total);
    EXPECT_DOUBLE_EQ(executor().status().target_elevation, want.q.theta);
    EXPECT_DOUBLE_EQ(executor().status().target_azimuth, want.q.phi);
    stepAt(target);
  }
  EXPECT_EQ(state(), MissionState::kCompleted);
}

TEST_F(MotionExecutorTest, FailsOnAContactThatThePlanHasNot) {
  add({2, 1, 1});
  add({3, 1, 1}, 3);
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  const ControlInput hold = stepAt({1.95, 1, 1}).control;
  EXPECT_EQ(state(), MissionState::kFailed);
  EXPECT_EQ(failure(), MissionFailure::kBadContact);
  EXPECT_EQ(hold.p_WE, Eigen::Vector3d(1.95, 1, 1));
  EXPECT_EQ(contacts_.activeId(), kReelContact);
  EXPECT_FALSE(executor().pause());
}

TEST_F(MotionExecutorTest, FailsOnATargetBeyondTheTether) {
  addContact(1, {0, 5, 0});
  add({2, 1, 1});
  add({4, 0, 3}, 1);  // 5 m static and 7.07 m free, of 10
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  stepAt({2, 1, 1});
  EXPECT_EQ(state(), MissionState::kFailed);
  EXPECT_EQ(failure(), MissionFailure::kUnreachable);
}

TEST_F(MotionExecutorTest, FailsWithoutAStaticTetherShapeOnlyAfterAWhile) {
  config_.target.model = TetherModel::kCatenary;
  add({0, 0.5, 5.0});
  ASSERT_TRUE(executor().start(*plan_, at({0, 0.5, 2.0})));
  Estimate slack = at({0, 0.5, 2.0});
  slack.T = 0.1;  // needs about 0.25 N
  for (int i = 0; i < 15; ++i) (void)executor().update(kStep, {.estimate = slack});
  EXPECT_EQ(state(), MissionState::kRunning);
  stepAt({0, 0.5, 2.0});  // tension back for a moment: counted anew
  for (int i = 0; i < 15; ++i) (void)executor().update(kStep, {.estimate = slack});
  EXPECT_EQ(state(), MissionState::kRunning);
  for (int i = 0; i < 10; ++i) (void)executor().update(kStep, {.estimate = slack});
  EXPECT_EQ(failure(), MissionFailure::kUnreachable);
}

TEST_F(MotionExecutorTest, FailsWhenItComesNoNearer) {
  add({3, 1, 1});
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  stepAt({1.5, 1, 1}, 140);
  EXPECT_EQ(state(), MissionState::kRunning);
  stepAt({1.6, 1, 1});  // progress
  stepAt({1.62, 1, 1}, 140);
  EXPECT_EQ(state(), MissionState::kRunning);
  stepAt({1.62, 1, 1}, 12);
  EXPECT_EQ(state(), MissionState::kFailed);
  EXPECT_EQ(failure(), MissionFailure::kNoProgress);
}

TEST_F(MotionExecutorTest, FailsWhenItTakesTooLong) {
  config_.progress_time_s = 3600.0;
  add({3, 1, 1}, 0, 0.0, 0.5);  // 2 m at 0.5 m/s: 3 * 4 s + 30 s
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  stepAt({1.5, 1, 1}, 419);
  EXPECT_EQ(state(), MissionState::kRunning);
  stepAt({1.5, 1, 1}, 3);
  EXPECT_EQ(state(), MissionState::kFailed);
  EXPECT_EQ(failure(), MissionFailure::kWaypointTimeout);
  EXPECT_NEAR(toSeconds(executor().status().time_on_waypoint), 42.1, 0.2);
}

TEST_F(MotionExecutorTest, AcceptanceRadiusFollowsTheUncertaintyBetweenFloorAndCeiling) {
  add({3, 1, 1});
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  const auto radius = [&](double sigma) {
    (void)executor().update(kStep, {.estimate = at({1, 1, 1}, sigma)});
    return executor().status().acceptance_radius;
  };
  EXPECT_DOUBLE_EQ(radius(0.001), 0.15);
  EXPECT_NEAR(radius(0.07), 2.0 * 0.07 * std::sqrt(3.0), 1e-12);
  EXPECT_DOUBLE_EQ(radius(1.0), 0.4);
}

TEST_F(MotionExecutorTest, PassesAWaypointOnTheWayByProgressWithinTheCorridor) {
  add({2, 1, 1.5});
  add({3, 1, 1.5});
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1.5})));
  stepAt({1.95, 1, 2.0});  // beside, not yet beyond
  EXPECT_EQ(executor().status().waypoint, 0);
  stepAt({2.01, 1, 2.2});  // beyond, outside the corridor
  EXPECT_EQ(executor().status().waypoint, 0);
  stepAt({2.01, 1, 2.0});
  EXPECT_EQ(executor().status().waypoint, 1);
  stepAt({3.01, 1, 2.0});  // the last one is not passed
  EXPECT_EQ(state(), MissionState::kRunning);
}

TEST_F(MotionExecutorTest, DoesNotPassAWaypointWhereItIsToHoldOrAContactChanges) {
  addContact(1, {0.5, 0.5, 0.5});
  add({2, 1, 1.5}, 0, 1.0);
  add({3, 1, 1.5}, 0);
  add({4, 1, 1.5}, 1);
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1.5})));
  stepAt({2.3, 1, 1.9});
  EXPECT_EQ(state(), MissionState::kRunning);
  EXPECT_EQ(executor().status().waypoint, 0);
  stepAt({2, 1, 1.5}, 12);
  EXPECT_EQ(executor().status().waypoint, 1);
  stepAt({3.1, 1, 1.8});
  EXPECT_EQ(executor().status().waypoint, 1);
}

TEST_F(MotionExecutorTest, InsideThePoleCylinderOnlyProgressCounts) {
  add({0.2, 1.5, 0});
  add({-0.2, 1.5, 0});
  add({-1.0, 1.5, 0});
  ASSERT_TRUE(executor().start(*plan_, at({1, 1.5, 0})));
  stepAt({0.25, 1.5, 0.05});  // well within the acceptance radius, but short of it
  EXPECT_EQ(executor().status().waypoint, 0);
  stepAt({0.15, 1.5, 0.35});  // on the detour, outside the acceptance radius
  EXPECT_EQ(executor().status().waypoint, 1);
  stepAt({-0.25, 1.5, 0.3});
  EXPECT_EQ(executor().status().waypoint, 2);
}

TEST_F(MotionExecutorTest, APointToStopAtOnTheAxisCountsFromAnyAzimuth) {
  ASSERT_TRUE(executor().goTo({.p_WD = {0, 1.5, 0}}, at({1, 1, 0})));
  stepAt({0.4, 1.2, 0});  // too low
  EXPECT_EQ(state(), MissionState::kRunning);
  stepAt({0.4, 1.4, 0});
  EXPECT_EQ(state(), MissionState::kCompleted);
}

TEST_F(MotionExecutorTest, GoesToASinglePointAndLeavesTheContactsAlone) {
  addContact(1, {1, 1, 0});
  ASSERT_EQ(contacts_.select(1, *plan_), ContactStack::Change::kPushed);
  ASSERT_TRUE(executor().goTo({.p_WD = {2, 2, 2}, .speed = 0.2}, at({2, 1, 2})));
  const ControlInput in = stepAt({2, 1, 2}).control;
  EXPECT_EQ(in.p_WE, Eigen::Vector3d(2, 2, 2));
  EXPECT_EQ(in.speed, 0.2);
  EXPECT_EQ(contacts_.activeId(), 1);
  EXPECT_EQ(executor().status().mission_hash, 0U);
  stepAt({2, 1.95, 2});
  EXPECT_EQ(state(), MissionState::kCompleted);
}

TEST_F(MotionExecutorTest, GoesBackTheWayFlownAndUndoesTheContactsInReverse) {
  addContact(1, {1, 1, 0});
  addContact(2, {2, 1, 0});
  add({2, 1, 1});
  add({3, 1, 1}, 1);
  add({4, 1, 3}, 2);
  add({5, 1, 3}, 2);
  FlownPath path;
  path.begin({1, 1, 1});
  const auto flyTo = [&](const Eigen::Vector3d& p_WD) {
    stepAt(p_WD);
    path.record(p_WD, contacts_, true);
  };
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  for (int i = 0; i < 3; ++i) flyTo(plan_->waypoints[static_cast<std::size_t>(i)].p_WD);
  const Eigen::Vector3d here(4.4, 1, 3);  // on the way to waypoint 3
  flyTo(here);
  ASSERT_TRUE(executor().goTo({.p_WD = here}, at(here)));  // operator's hold
  ASSERT_TRUE(executor().goBack(path, 100.0, 0.25, at(here)));
  const std::vector<Eigen::Vector3d> way{{4, 1, 3}, {3, 1, 1}, {2, 1, 1}, {1, 1, 1}};
  const std::vector<int> ids{2, 2, 1, 0};
  for (std::size_t i = 0; i < way.size(); ++i) {
    EXPECT_EQ(contacts_.activeId(), ids[i]) << i;
    const Eigen::Vector3d before = way[i] + Eigen::Vector3d(0.4, 0, 0);
    EXPECT_EQ(stepAt(before).control.p_WE, way[i]);
    EXPECT_EQ(stepAt(before).control.speed, 0.25);
    path.cutAfter(executor().status().waypoint);
    if (i == 1) {  // interrupted: goes on from the leg it was on, not from the far end again
      executor().abort();
      ASSERT_TRUE(executor().goBack(path, 100.0, 0.25, at(before)));
      EXPECT_EQ(stepAt(before).control.p_WE, way[i]);
      ASSERT_TRUE(executor().pause());
      ASSERT_TRUE(executor().resume());
    }
    stepAt(way[i]);
  }
  EXPECT_EQ(state(), MissionState::kCompleted);
  EXPECT_EQ(contacts_.contactCount(), 0);
}

TEST_F(MotionExecutorTest, StandsStillInTheMissionWhileTheEstimateIsLost) {
  add({2, 1, 1});
  add({3, 1, 1});
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  Estimate lost = at({2, 1, 1});
  lost.health = EstimateHealth::kLost;
  (void)executor().update(kStep, {.estimate = lost});
  EXPECT_EQ(executor().status().waypoint, 0);
  EXPECT_EQ(executor().status().distance, 1.0);  // from where it was last seen
  stepAt({2, 1, 1});
  EXPECT_EQ(executor().status().waypoint, 1);
}

TEST_F(MotionExecutorTest, TurnsTowardsThePointOfItsWaypoint) {
  add({2, 1, 1});
  plan_->waypoints[0].p_WL = Eigen::Vector3d(1, 2, 3);
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  const ExecutorOutput blind = stepAt({1, 1, 1});
  EXPECT_EQ(blind.yaw_rate, 0.0);
  EXPECT_EQ(blind.gimbal_pitch_rate, 0.0);
  const ExecutorOutput out =
      executor().update(kStep, {.estimate = at({1, 1, 1}),
                                .R_WB = Eigen::Quaterniond::Identity(),  // looks along x_W
                                .gimbal_pitch = 0.0});
  EXPECT_LT(out.yaw_rate, 0.0);  // the point is along z_W: azimuth from 90 deg to 0
  EXPECT_GT(out.gimbal_pitch_rate, 0.0);
}

TEST_F(MotionExecutorTest, SurvivesAPlanOfNonsense) {
  add(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  ASSERT_TRUE(executor().start(*plan_, at({1, 1, 1})));
  EXPECT_EQ(state(), MissionState::kFailed);
  EXPECT_EQ(failure(), MissionFailure::kUnreachable);
  const ExecutorOutput out = stepAt({1, 1, 1});
  EXPECT_TRUE(out.control.p_WE.allFinite());
}

TEST_F(MotionExecutorTest, PassesManyCoincidentWaypoints) {
  for (int i = 0; i < 5; ++i) add({0.1, 1.5, 0});  // even inside the pole cylinder
  ASSERT_TRUE(executor().start(*plan_, at({0.1, 1.5, 0})));
  stepAt({0.1, 1.5, 0}, 6);
  EXPECT_EQ(state(), MissionState::kCompleted);
}

}  // namespace
}  // namespace tautline
