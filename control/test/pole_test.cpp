#include "control/pole.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "control/unwrapped_chart.h"

namespace tautline {
namespace {

const PoleConfig kConfig;
const VehicleLimits kFast{.elevation_rate_radps = 0.6, .azimuth_rate_radps = 1.0};

TEST(PoleCylinder, IsAsWideAsTheAzimuthRateNeeds) {
  const PoleCylinder fast = poleCylinder(kConfig, kFast);
  EXPECT_DOUBLE_EQ(fast.speed, 0.15);
  EXPECT_DOUBLE_EQ(fast.radius, 0.195);
  EXPECT_DOUBLE_EQ(fast.outer_radius, 0.345);
  const PoleCylinder device = poleCylinder(kConfig, VehicleLimits{});
  EXPECT_DOUBLE_EQ(device.radius, kConfig.radius_max_m);  // and slower instead of wider
  EXPECT_LT(device.speed, 0.06);
  EXPECT_NEAR(device.speed / device.radius * kConfig.rate_reserve, 0.2, 1e-12);
}

TEST(PoleDetour, GoesRoundTheAxisWithoutEnteringTheCylinderOrTurningBack) {
  const PoleCylinder pole = poleCylinder(kConfig, kFast);
  for (double offset = -0.3; offset <= 0.3; offset += 0.05) {
    PoleDetour detour(kConfig);
    Eigen::Vector3d p(-1.0, 1.5, offset);
    const Eigen::Vector3d goal(1.0, 1.5, offset);
    double nearest = 1e9, t = 0.0;
    for (; (goal - p).norm() > 0.02 && t < 60.0; t += 0.01) {
      p += 0.01 * detour.steer(pole, p, goal, 0.3);
      nearest = std::min(nearest, axisDistance(p));
    }
    EXPECT_LT(t, 15.0) << offset;
    EXPECT_GT(nearest, 0.98 * pole.radius) << offset;
  }
}

TEST(PoleDetour, FromTheAxisItselfTheWayIsOut) {
  const PoleCylinder pole = poleCylinder(kConfig, kFast);
  PoleDetour detour(kConfig);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 1.5, 0), Eigen::Vector3d(0.01, 1.5, -0.02)}) {
    const Eigen::Vector3d v = detour.steer(pole, p, {-2.0, 1.5, 0.5}, 0.3);
    EXPECT_NEAR(v.norm(), pole.speed, 1e-9);
    EXPECT_GT(axisDistance(p + 0.01 * v), axisDistance(p));
  }
}

TEST(PoleDetour, LeavesEverythingElseAlone) {
  const PoleCylinder pole = poleCylinder(kConfig, kFast);
  PoleDetour detour(kConfig);
  const Eigen::Vector3d p(0.0, 1.0, 0.5);
  const Eigen::Vector3d away = detour.steer(pole, p, {0.0, 1.0, 2.0}, 0.3);
  EXPECT_TRUE(away.isApprox(Eigen::Vector3d(0, 0, 0.3)));
  const Eigen::Vector3d past = detour.steer(pole, p, {2.0, 1.0, 0.5}, 0.3);
  EXPECT_TRUE(past.isApprox(Eigen::Vector3d(0.3, 0, 0)));
  const Eigen::Vector3d up = detour.steer(pole, p, {0.0, 2.0, 0.5}, 0.3);
  EXPECT_TRUE(up.isApprox(Eigen::Vector3d(0, 0.3, 0)));
  EXPECT_TRUE(detour.steer(pole, p, p, 0.3).isZero());
}

TEST(PoleDetour, MovesAGoalOutOfTheCylinder) {
  const PoleCylinder pole = poleCylinder(kConfig, kFast);
  const Eigen::Vector3d p(0.5, 1.0, 0.0), inside(0.05, 1.2, 0.03);
  const Eigen::Vector3d on =
      PoleDetour::outsideGoal(pole, p, inside, Eigen::Vector3d(-2.0, 0.5, 0.1));
  EXPECT_NEAR(axisDistance(on), pole.radius, 1e-12);
  EXPECT_NEAR((on - inside).normalized().dot(Eigen::Vector3d(-2.0, 0.5, 0.1).normalized()), 1.0,
              1e-12);
  for (const Eigen::Vector3d& heading : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 1, 0)}) {
    const Eigen::Vector3d hover = PoleDetour::outsideGoal(pole, p, inside, heading);
    EXPECT_TRUE(hover.isApprox(Eigen::Vector3d(pole.radius, 1.2, 0.0)));
  }
  const Eigen::Vector3d outside(1.0, 1.0, 1.0);
  EXPECT_EQ(PoleDetour::outsideGoal(pole, p, outside, {1, 0, 0}), outside);
}

TEST(UnwrappedChart, GoesBeyond90DegreesWhereTheFoldedAnglesFlip) {
  UnwrappedChart chart;
  TetherCoordinates last = chart.follow(0.0, {0.0, 1.5, 1.0}, 0.0, 0.1);
  for (double z = 1.0; z >= -1.0; z -= 0.005) {
    const Eigen::Vector3d p(0.0, 1.5, z);
    const TetherCoordinates q = chart.follow(0.02, p, 0.0, 0.1);
    EXPECT_LT(std::abs(q.theta - last.theta), 0.01);
    EXPECT_EQ(q.phi, 0.0);
    EXPECT_TRUE(toCartesian(q).isApprox(p, 1e-9));
    last = q;
  }
  EXPECT_GT(last.theta, std::numbers::pi / 2);
}

TEST(UnwrappedChart, InvertsTheJacobianFarFromTheAxisOnBothSides) {
  UnwrappedChart chart;
  const Eigen::Vector3d v(0.1, -0.2, 0.3);
  (void)chart.follow(0.0, {0.0, 1.5, 2.0}, 0.0, 0.01);
  for (const double z : {2.0, 0.0, -2.0}) {
    TetherCoordinates q;
    for (int i = 0; i < 200; ++i) q = chart.follow(0.1, {0.3 * z, 1.5, z}, 0.0, 0.01);
    if (z == 0.0) continue;
    EXPECT_TRUE(velocityFromRates(q, chart.rates(v)).isApprox(v, 1e-3)) << z;
  }
}

}  // namespace
}  // namespace tautline
