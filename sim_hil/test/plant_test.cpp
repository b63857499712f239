#include "sim_hil/plant.h"

#include <cmath>
#include <numbers>
#include <tuple>

#include <gtest/gtest.h>

#include "common/error.h"
#include "sim_hil/test/flight_rig.h"

namespace tautline::sim {
namespace {

TEST(Plant, StandsStillUntilToldToFly) {
  FlightRig rig;
  rig.run(5.0);
  EXPECT_TRUE(rig.truth().on_ground);
  EXPECT_FALSE(rig.truth().motors_on);
  EXPECT_FALSE(rig.truth().crashed);
  EXPECT_LT((rig.truth().p_WD - Eigen::Vector3d(0.0, -0.2, 0.9)).norm(), 0.003);
  EXPECT_LT(rig.truth().v_WD.norm(), 1e-3);
}

TEST(Plant, TakesOffToTheTakeOffElevation) {
  FlightRig rig;
  rig.takeOff();
  EXPECT_FALSE(rig.truth().on_ground);
  EXPECT_NEAR(rig.truth().tangent_elevation, radians(50), 0.02);
  EXPECT_NEAR(rig.truth().tangent_azimuth, 0.0, 0.01);
  EXPECT_NEAR(rig.truth().tension, 1.0, 0.05);
  EXPECT_NEAR(rig.truth().p_WD.norm(), rig.truth().length, 0.01);
  EXPECT_EQ(rig.plant().vehicle().phase(), FlightPhase::kFlying);
}

class Hold : public ::testing::TestWithParam<std::tuple<double, double, double>> {};

TEST_P(Hold, SettlesWellDampedAfterATurn) {
  const auto [L, theta_deg, T] = GetParam();
  SimConfig config = calmConfig();
  config.vehicle.tension = T;
  FlightRig rig(config);
  rig.takeOff();
  rig.goTo(L, radians(theta_deg), 0.3);
  const Truth& truth = rig.truth();
  ASSERT_FALSE(truth.crashed);
  const double w = config.tether.density * 9.81;
  EXPECT_NEAR(truth.tension, T, 0.1 * T + 0.02);
  EXPECT_NEAR(truth.tangent_elevation, radians(theta_deg), 0.03 + 0.05 * w * L / T);
  EXPECT_NEAR(wrapped(truth.tangent_azimuth - 0.3), 0.0, 0.03);
  EXPECT_LT(truth.v_WD.norm(), 0.03);

  // Turn by 0.1 rad in 0.5 s, then hold.
  const Eigen::Vector3d before = truth.p_WD;
  rig.rates(0.0, 0.2);
  rig.run(0.5);
  rig.rates(0.0, 0.0);
  double peak = 0.0;
  double settled = 0.0;  // last time that it was more than 0.01 rad off
  double t = 0.0;
  const double goal = truth.setpoint_azimuth;
  const auto azimuth = [&] { return std::atan2(truth.p_WD.x(), truth.p_WD.z()); };
  const auto watch = [&] {
    t += config.step;
    peak = std::fmax(peak, azimuth() - goal);
    if (std::abs(azimuth() - goal) > 0.01) settled = t;
  };
  rig.run(2.0, watch);
  EXPECT_LT(peak, 0.04) << "overshoot";
  EXPECT_NEAR(azimuth(), goal, 0.02) << "after 2 s";
  rig.run(2.0, watch);
  // For docs/simulator.md: sim_hil_test --gtest_output=json:figures.json
  RecordProperty("settled_ms", static_cast<int>(1000.0 * settled));
  RecordProperty("overshoot_mrad", static_cast<int>(1000.0 * peak));
  EXPECT_NEAR(azimuth(), goal, 0.01) << "after 4 s";
  EXPECT_GT((truth.p_WD - before).norm(), 0.05 * L * std::cos(radians(theta_deg)));
}
INSTANTIATE_TEST_SUITE_P(Grid, Hold,
                         ::testing::Combine(::testing::Values(0.5, 1.0, 2.0, 4.0),
                                            ::testing::Values(20.0, 50.0, 75.0),
                                            ::testing::Values(0.6, 2.0)));

// A long tether's own sideways waves are as slow as the loop: it rests later.
class HoldFar : public ::testing::TestWithParam<double> {};

TEST_P(HoldFar, ComesToRestAtEightMetres) {
  FlightRig rig;
  rig.takeOff();
  rig.goTo(8.0, radians(GetParam()), 0.3);
  rig.run(8.0);
  EXPECT_LT(rig.truth().v_WD.norm(), 0.03);
  EXPECT_NEAR(rig.truth().tension, 1.0, 0.05);
  EXPECT_NEAR(rig.truth().tangent_elevation, radians(GetParam()), 0.03);
  EXPECT_NEAR(rig.truth().tangent_azimuth, 0.3, 0.03);
}
INSTANTIATE_TEST_SUITE_P(Elevation, HoldFar, ::testing::Values(20.0, 50.0, 75.0));

TEST(Plant, HoldsAtThePublishedLowTension) {
  SimConfig config = calmConfig();
  config.vehicle.tension = 0.3;
  FlightRig rig(config);
  rig.takeOff();
  rig.goTo(2.5, radians(45), 0.0);
  EXPECT_NEAR(rig.truth().tension, 0.3, 0.04);
  EXPECT_NEAR(rig.truth().tangent_elevation, radians(45), 0.05);
  // The chord is well below the tangent at this tension: sag.
  const double chord = std::asin(rig.truth().p_WD.y() / rig.truth().p_WD.norm());
  EXPECT_GT(rig.truth().tangent_elevation - chord, 0.1);
}

TEST(Plant, FollowsRateCommands) {
  FlightRig rig;
  rig.takeOff();
  rig.goTo(2.0, radians(45), 0.0);
  rig.rates(0.1, -0.15);
  rig.run(1.0);
  const double e0 = rig.truth().tangent_elevation;
  const double a0 = rig.truth().tangent_azimuth;
  rig.run(2.0);
  EXPECT_NEAR((rig.truth().tangent_elevation - e0) / 2.0, 0.1, 0.015);
  EXPECT_NEAR((rig.truth().tangent_azimuth - a0) / 2.0, -0.15, 0.02);
}

TEST(Plant, SetPointStopsBelowThePoleAndAzimuthStillTurns) {
  FlightRig rig;
  rig.takeOff();
  rig.goTo(1.5, radians(70), 0.0);
  rig.rates(0.25, 0.0);
  rig.run(4.0);
  EXPECT_DOUBLE_EQ(rig.truth().setpoint_elevation, radians(89.5));
  rig.rates(0.0, 0.2);
  rig.run(3.0);
  EXPECT_DOUBLE_EQ(rig.truth().setpoint_elevation, radians(89.5));
  EXPECT_NEAR(rig.truth().setpoint_azimuth, 0.6, 0.01);
  // Over the reel: a turned azimuth set-point hardly moves the vehicle.
  EXPECT_LT(std::hypot(rig.truth().p_WD.x(), rig.truth().p_WD.z()), 0.1);
  EXPECT_FALSE(rig.truth().crashed);
}

TEST(Plant, LandsSoftlyAndStays) {
  FlightRig rig;
  rig.takeOff();
  rig.rates(-0.2, 0.0);
  for (int i = 0; i < 5000 && !rig.truth().on_ground; ++i) rig.plant().step();
  ASSERT_TRUE(rig.truth().on_ground);
  rig.rates(0.0, 0.0);
  rig.run(1.0);
  EXPECT_TRUE(rig.truth().on_ground);
  EXPECT_LT(rig.truth().v_WD.norm(), 0.02);
  rig.plant().vehicle().stopMotors();
  rig.run(1.0);
  EXPECT_FALSE(rig.truth().crashed);
  EXPECT_FALSE(rig.truth().motors_on);
}

TEST(Plant, MotorsOffInTheAirIsACrash) {
  FlightRig rig;
  rig.takeOff();
  rig.goTo(1.5, radians(60), 0.0);
  rig.plant().vehicle().stopMotors();
  rig.run(3.0);
  EXPECT_TRUE(rig.truth().crashed);
  EXPECT_EQ(rig.truth().crash_reason, CrashReason::kHardLanding);
  EXPECT_TRUE(rig.truth().on_ground);
}

TEST(Plant, TouchingAnObstacleOrTheRoomIsACrash) {
  Scene scene = emptyRoom();
  scene.boxes.push_back({"wall", {0.6, -0.3, -1.0}, {0.8, 3.0, 3.0}});
  FlightRig rig(calmConfig(), scene);
  rig.takeOff();
  rig.goTo(0.92, radians(30), 0.0);
  rig.rates(0.0, 0.2);
  rig.run(8.0);
  EXPECT_EQ(rig.truth().crash_reason, CrashReason::kObstacle);
  EXPECT_FALSE(rig.truth().motors_on);

  Scene low = emptyRoom();
  low.max.y() = 0.9;
  FlightRig under(calmConfig(), low);
  under.takeOff();
  under.goTo(1.5, radians(60), 0.0);
  EXPECT_EQ(under.truth().crash_reason, CrashReason::kRoom);
}

TEST(Plant, TheTetherBendsRoundAPillarInFlight) {
  Scene scene = emptyRoom();
  scene.boxes.push_back({"pillar", {0.4, -0.3, 0.7}, {0.8, 3.0, 1.1}});
  SimConfig config = calmConfig();
  FlightRig rig(config, scene);
  rig.takeOff();
  rig.goTo(2.0, radians(35), 0.0);
  ASSERT_FALSE(rig.truth().crashed);
  EXPECT_EQ(rig.truth().contact_count, 0);
  rig.rates(0.0, 0.15);
  rig.run(6.0);
  rig.rates(0.0, 0.0);
  rig.run(3.0);
  const Truth& truth = rig.truth();
  ASSERT_FALSE(truth.crashed);
  ASSERT_EQ(truth.contact_count, 1);
  EXPECT_NEAR(truth.p_WA.x(), 0.4, 0.01);
  EXPECT_NEAR(truth.p_WA.z(), 1.1, 0.01);
  // Beyond the contact the tangent is held relative to the contact.
  const Eigen::Vector3d p_AD = truth.p_WD - truth.p_WA;
  EXPECT_NEAR(std::atan2(p_AD.x(), p_AD.z()), truth.setpoint_azimuth, 0.05);
  EXPECT_NEAR(truth.p_WA.norm() + p_AD.norm(), truth.length, 0.03);
  EXPECT_GT(std::atan2(truth.p_WD.x(), truth.p_WD.z()), std::atan2(0.4, 1.1));
  // And back.
  rig.rates(0.0, -0.15);
  rig.run(6.0);
  rig.rates(0.0, 0.0);
  rig.run(3.0);
  EXPECT_EQ(truth.contact_count, 0);
  EXPECT_NEAR(truth.p_WD.norm(), truth.length, 0.03);
}

TEST(Plant, StartMustSeeTheReel) {
  Scene scene = emptyRoom();
  scene.boxes.push_back({"box", {-0.1, -0.3, 0.4}, {0.1, 0.5, 0.5}});
  EXPECT_THROW(Plant(calmConfig(), scene, 1), InputError);
}

TEST(Plant, ReelScaleErrorIsInTheLengthNotInTheCounts) {
  SimConfig config = calmConfig();
  config.reel.scale = 1.1;
  FlightRig rig(config);
  rig.takeOff();
  const double before = rig.truth().length;
  const auto counts = rig.plant().reel().counts();
  rig.plant().reel().lock(false);
  rig.plant().reel().command(100.0);
  rig.run(3.0);
  const double nominal =
      static_cast<double>(rig.plant().reel().counts() - counts) * config.reel.metres_per_count;
  EXPECT_NEAR(rig.truth().length - before, 1.1 * nominal, 0.005);
}

TEST(Plant, GustsMoveTheVehicleAndMoreSoNearWalls) {
  const auto spread = [](double wall_factor) {
    SimConfig config;
    config.wind.gust = 0.3;
    config.wind.wall_factor = wall_factor;
    config.wind.wall_distance = 5.0;
    FlightRig rig(config);
    rig.takeOff();
    double sum = 0.0;
    int count = 0;
    rig.run(30.0, [&] {
      sum += rig.truth().gust.squaredNorm();
      ++count;
    });
    EXPECT_FALSE(rig.truth().crashed);
    return std::sqrt(sum / count / 3.0);
  };
  const double open = spread(0.0);
  EXPECT_NEAR(open, 0.3, 0.12);
  EXPECT_GT(spread(2.0), 1.5 * open);
}

}  // namespace
}  // namespace tautline::sim
