#include "control/look_at.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace tautline {
namespace {

using std::numbers::pi;

const LookAtConfig kConfig;
const VehicleLimits kLimits;
const Eigen::Vector3d kDrone(1.0, 1.5, -0.5);

Eigen::Quaterniond yawed(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
}

TEST(LookAt, ForwardIsTheBodysXAxis) {
  EXPECT_NEAR(*headingOf(yawed(0.0)), pi / 2, 1e-12);   // x_W has azimuth 90 deg
  EXPECT_NEAR(*headingOf(yawed(-pi / 2)), 0.0, 1e-12);  // z_W has azimuth 0
  EXPECT_FALSE(headingOf(
      Eigen::Quaterniond(Eigen::AngleAxisd(pi / 2, Eigen::Vector3d::UnitZ()))));  // nose up
}

TEST(LookAt, PositiveYawRateBringsTheHeadingNearerFromAnyAngle) {
  for (double yaw = -3.1; yaw < 3.2; yaw += 0.31) {
    for (double azimuth = -3.1; azimuth < 3.2; azimuth += 0.37) {
      const Eigen::Vector3d p_WL =
          kDrone + 2.0 * Eigen::Vector3d(std::sin(azimuth), 0.0, std::cos(azimuth));
      const LookAtRates rates = lookAt(kConfig, kLimits, kDrone, p_WL, yawed(yaw), {});
      // Oracle without angles: the turn that brings the forward axis nearer to the line of sight.
      const auto nearness = [&](double angle) {
        return (yawed(angle) * Eigen::Vector3d::UnitX()).dot((p_WL - kDrone).normalized());
      };
      if (nearness(yaw) > 0.9999 || nearness(yaw) < -0.99) continue;
      EXPECT_GT(nearness(yaw + 1e-3 * rates.yaw_rate), nearness(yaw));
      EXPECT_LE(std::abs(rates.yaw_rate), kLimits.yaw_rate_radps);
    }
  }
}

TEST(LookAt, ConvergesOnThePointWithYawAndGimbal) {
  const Eigen::Vector3d p_WL(-1.0, 0.5, 2.0);
  double yaw = 2.9, pitch = 0.4;
  for (int i = 0; i < 3000; ++i) {
    const LookAtRates rates = lookAt(kConfig, kLimits, kDrone, p_WL, yawed(yaw), pitch);
    yaw += 0.01 * rates.yaw_rate;
    pitch += 0.01 * rates.gimbal_pitch_rate;
  }
  const Eigen::Vector3d ahead = yawed(yaw) * Eigen::Vector3d(std::cos(pitch), std::sin(pitch), 0.0);
  EXPECT_NEAR((p_WL - kDrone).normalized().dot(ahead), 1.0, 1e-9);
}

TEST(LookAt, RestsWhereItLacksAMeasurementOrADirection) {
  const Eigen::Vector3d below = kDrone - Eigen::Vector3d(0.05, 1.0, 0.0);
  EXPECT_EQ(lookAt(kConfig, kLimits, kDrone, below, yawed(1.0), 0.0).yaw_rate, 0.0);
  EXPECT_LT(lookAt(kConfig, kLimits, kDrone, below, yawed(1.0), 0.0).gimbal_pitch_rate, 0.0);
  const Eigen::Vector3d aside = kDrone + Eigen::Vector3d(0.0, 1.0, 2.0);
  EXPECT_EQ(lookAt(kConfig, kLimits, kDrone, aside, {}, 0.0).yaw_rate, 0.0);
  EXPECT_EQ(lookAt(kConfig, kLimits, kDrone, aside, yawed(1.0), {}).gimbal_pitch_rate, 0.0);
  EXPECT_EQ(lookAt(kConfig, kLimits, kDrone, kDrone, yawed(1.0), 0.3).gimbal_pitch_rate, 0.0);
  const Eigen::Vector3d nan = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(lookAt(kConfig, kLimits, kDrone, nan, yawed(1.0), 0.3).yaw_rate, 0.0);
}

}  // namespace
}  // namespace tautline
