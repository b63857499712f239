#include "sim_hil/camera.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tautline::sim {
namespace {

CameraConfig sharp() {
  CameraConfig config;
  config.timing = {10.0, 0.2, 0.0};
  config.bearing_noise = config.depth_noise = config.rotation_noise = 0.0;
  return config;
}

/// Marker 2 m along -z from the camera's place, looking back at it.
const Pose kEye{{1.0, 1.0, 1.0}, cameraToWorld(0.5 * std::numbers::pi, 0.0)};
const Pose kMarker{{1.0, 1.0, -1.0}, cameraToWorld(-0.5 * std::numbers::pi, 0.0)};

std::optional<MarkerDetection> look(const Pose& eye, const Pose& marker,
                                    const CameraConfig& config = sharp()) {
  Camera camera(config);
  Random random(1);
  camera.step(Time{}, eye, marker, random);
  return camera.read(Time{} + std::chrono::seconds(1));
}

TEST(Camera, SeesWhatIsBeforeItFromItsOwnPlace) {
  const auto seen = look(kEye, kMarker);
  ASSERT_TRUE(seen);
  EXPECT_LT((seen->marker.position - Eigen::Vector3d(2.0, 0.0, 0.0)).norm(), 1e-12);
  const Eigen::Vector3d face = seen->marker.rotation * Eigen::Vector3d::UnitX();
  EXPECT_LT((face + Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST(Camera, AxesAreForwardUpRight) {
  Pose eye = kEye;
  eye.rotation = cameraToWorld(0.0, 0.0);  // looks along +x: right is +z
  Pose marker{{3.0, 1.2, 1.5}, cameraToWorld(std::numbers::pi, 0.0)};
  const auto seen = look(eye, marker);
  ASSERT_TRUE(seen);
  EXPECT_LT((seen->marker.position - Eigen::Vector3d(2.0, 0.2, 0.5)).norm(), 1e-12);
  eye.rotation = cameraToWorld(0.0, 0.1);  // looks up: the marker sinks in the picture
  EXPECT_LT(look(eye, marker)->marker.position.y(), 0.05);
}

TEST(Camera, DoesNotSeeWhatIsAsideFarObliqueOrTurnedAway) {
  Pose marker = kMarker;
  marker.position.x() += 1.5;
  EXPECT_FALSE(look(kEye, marker)) << "aside";
  marker = kMarker;
  marker.position.z() = -4.0;
  EXPECT_FALSE(look(kEye, marker)) << "far";
  marker = kMarker;
  marker.rotation = cameraToWorld(-0.5 * std::numbers::pi + radians(70), 0.0);
  EXPECT_FALSE(look(kEye, marker)) << "oblique";
  marker.rotation = cameraToWorld(0.5 * std::numbers::pi, 0.0);
  EXPECT_FALSE(look(kEye, marker)) << "turned away";
}

TEST(Camera, PicturesComeAtTheirRateAndLate) {
  Camera camera(sharp());
  Random random(1);
  int fresh = 0;
  std::optional<Time> last;
  for (Time now{}; now < Time{} + std::chrono::seconds(2); now += std::chrono::milliseconds(10)) {
    camera.step(now, kEye, kMarker, random);
    const auto seen = camera.read(now);
    if (!seen) continue;
    EXPECT_GE(now - seen->taken, std::chrono::milliseconds(200));
    EXPECT_LE(now - seen->taken, std::chrono::milliseconds(300));
    fresh += last != seen->taken ? 1 : 0;
    last = seen->taken;
  }
  EXPECT_EQ(fresh, 18);  // 10 a second, the first after 0.2 s
}

TEST(Camera, NoiseIsAsConfigured) {
  CameraConfig config = sharp();
  config.bearing_noise = 0.01;
  config.depth_noise = 0.02;
  Camera camera(config);
  Random random(7);
  double depth = 0.0;
  double right = 0.0;
  constexpr int kPictures = 4000;
  Time now{};
  for (int i = 0; i < kPictures; ++i, now += std::chrono::milliseconds(100)) {
    camera.step(now, kEye, kMarker, random);
    const auto seen = camera.read(now + std::chrono::milliseconds(205));
    ASSERT_TRUE(seen);
    depth += std::pow(seen->marker.position.x() - 2.0, 2);
    right += std::pow(seen->marker.position.z(), 2);
  }
  EXPECT_NEAR(std::sqrt(depth / kPictures), 0.04, 0.003);
  EXPECT_NEAR(std::sqrt(right / kPictures), 0.02, 0.0015);
}

}  // namespace
}  // namespace tautline::sim
