#include "control/visual_servo.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "common/testing/malloc_guard.h"

namespace tautline {
namespace {

using std::chrono::milliseconds;

constexpr double kDt = 0.05;

/// A drone that does what the rates say, at once, and a marker that moves along a line.
struct Scene {
  Eigen::Vector3d p_WD{0.3, 1.2, 1.4};
  double azimuth{0.5 * std::numbers::pi};  // of the optical axis: body x with yaw 0 looks along +x
  double pitch{0.0};
  Eigen::Vector3d p_WM{1.3, 1.2, 1.4};
  Eigen::Vector3d v_WM{Eigen::Vector3d::Zero()};
  Eigen::Vector3d normal_W{-1.0, 0.0, 0.0};

  [[nodiscard]] Eigen::Quaterniond body() const {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(azimuth - 0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()));
  }
  [[nodiscard]] ServoInput input(Time now) const {
    const Eigen::Quaterniond to_camera =
        (body() * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitZ())).conjugate();
    ServoInput in;
    in.estimate.valid = true;
    in.estimate.health = EstimateHealth::kOk;
    in.estimate.p_WD = p_WD;
    in.R_WB = body();
    in.gimbal_pitch = pitch;
    in.sighting = Sighting{now, to_camera * (p_WM - p_WD), to_camera * normal_W};
    return in;
  }
  void move(const TeleopRates& rates) {
    const TetherCoordinates q = toTether(p_WD);
    p_WD += kDt * velocityFromRates(q, {rates.length, rates.elevation, rates.azimuth});
    azimuth += kDt * rates.yaw;
    pitch += kDt * rates.gimbal_pitch;
    p_WM += kDt * v_WM;
  }
};

class Law : public ::testing::TestWithParam<ServoLaw> {
 protected:
  static VisualServoConfig config() {
    VisualServoConfig c;
    c.law = GetParam();
    c.vehicle_lag_s = 0.0;
    return c;
  }
};

TEST_P(Law, ComesToRestBeforeAMarkerThatRests) {
  Scene scene;
  scene.p_WM = {1.6, 1.4, 1.2};
  scene.normal_W = Eigen::Vector3d(-1.0, 0.0, 0.4).normalized();
  VisualServo servo(config());
  Time now{std::chrono::seconds(1)};
  for (int i = 0; i < 1200; ++i, now += milliseconds(50))
    scene.move(servo.update(now, scene.input(now)));
  const Eigen::Vector3d wanted = scene.p_WM + config().standoff_m * scene.normal_W;
  EXPECT_LT((scene.p_WD - wanted).norm(), 0.01);
  const Eigen::Vector3d sight = scene.p_WM - scene.p_WD;
  EXPECT_NEAR(scene.azimuth, std::atan2(sight.x(), sight.z()), 0.01);
  EXPECT_NEAR(scene.pitch, std::atan2(sight.y(), std::hypot(sight.x(), sight.z())), 0.01);
}
INSTANTIATE_TEST_SUITE_P(VisualServo, Law,
                         ::testing::Values(ServoLaw::kTracking, ServoLaw::kAsPublished),
                         [](const auto& law) {
                           return law.param == ServoLaw::kTracking ? "Tracking" : "AsPublished";
                         });

TEST(VisualServo, TrackingKeepsUpWithAMovingMarkerAndThePublishedLawLags) {
  const auto lag = [](ServoLaw law) {
    Scene scene;
    scene.v_WM = {0.0, 0.02, -0.1};
    VisualServoConfig config;
    config.law = law;
    config.vehicle_lag_s = 0.0;
    VisualServo servo(config);
    Time now{std::chrono::seconds(1)};
    for (int i = 0; i < 240; ++i, now += milliseconds(50))
      scene.move(servo.update(now, scene.input(now)));
    return (scene.p_WD - scene.p_WM - config.standoff_m * scene.normal_W).norm();
  };
  EXPECT_LT(lag(ServoLaw::kTracking), 0.02);
  EXPECT_GT(lag(ServoLaw::kAsPublished), 0.2);
}

TEST(VisualServo, StandsStillWithoutSightEstimateOrAttitude) {
  const VisualServoConfig config;
  const auto still = [](const TeleopRates& r) {
    return r.length == 0.0 && r.elevation == 0.0 && r.azimuth == 0.0 && r.yaw == 0.0 &&
           r.gimbal_pitch == 0.0;
  };
  Scene scene;
  scene.p_WM.x() += 1.0;
  const Time now{std::chrono::seconds(1)};
  ServoInput blind = scene.input(now);
  blind.sighting.reset();
  EXPECT_TRUE(still(VisualServo(config).update(now, blind)));
  ServoInput lost = scene.input(now);
  lost.estimate.health = EstimateHealth::kLost;
  EXPECT_TRUE(still(VisualServo(config).update(now, lost)));
  ServoInput headless = scene.input(now);
  headless.R_WB.reset();
  EXPECT_TRUE(still(VisualServo(config).update(now, headless)));
  ServoInput broken = scene.input(now);
  broken.sighting->p_CM.x() = std::nan("");
  EXPECT_TRUE(still(VisualServo(config).update(now, broken)));

  VisualServo servo(config);
  EXPECT_FALSE(still(servo.update(now, scene.input(now))));
  const Time later = now + fromSeconds(config.lost_after_s + 0.1);
  EXPECT_TRUE(still(servo.update(later, blind))) << "the last sighting is too old";
  EXPECT_FALSE(servo.goal(later));
}

TEST(VisualServo, StaysInsideTheLimitsAndOffTheHeap) {
  Scene scene;
  scene.p_WM = {-2.5, 2.2, -1.0};
  scene.normal_W = {0.0, 0.0, 1.0};
  VisualServo servo(VisualServoConfig{});
  const VehicleLimits limits;
  constexpr double kRounding = 1e-12;
  Time now{std::chrono::seconds(1)};
  testing::MallocGuard guard;
  for (int i = 0; i < 400; ++i, now += milliseconds(50)) {
    const TeleopRates r = servo.update(now, scene.input(now));
    EXPECT_LE(std::abs(r.length), limits.length_rate_mps + kRounding);
    EXPECT_LE(std::abs(r.elevation), limits.elevation_rate_radps + kRounding);
    EXPECT_LE(std::abs(r.azimuth), limits.azimuth_rate_radps + kRounding);
    EXPECT_LE(std::abs(r.yaw), limits.yaw_rate_radps);
    EXPECT_LE(std::abs(r.gimbal_pitch), limits.gimbal_pitch_rate_radps);
    scene.move(r);
  }
  if (testing::MallocGuard::available()) {
    EXPECT_EQ(guard.allocations(), 0);
  }
}

}  // namespace
}  // namespace tautline
