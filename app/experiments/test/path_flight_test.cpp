#include "app/experiments/path_flight.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "app/bench/lockstep.h"
#include "common/mission/scene.h"
#include "sim_hil/fault.h"

namespace tautline::experiments {
namespace {

const std::filesystem::path kConfig = std::filesystem::path(TAUTLINE_SOURCE_DIR) / "config";

experiments::Setup shipped() { return loadSetup(kConfig / "experiments", true, 1); }

/// Regular polygon of n corners on a circle, from angle 0 to `angle`.
std::vector<Eigen::Vector3d> arc(int n, double radius, double angle) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= n; ++i) {
    const double a = angle * i / n;
    points.emplace_back(radius * std::cos(a), 1.5, radius * std::sin(a));
  }
  return points;
}

TEST(Track, MeasuresOfACircleAreThoseOfGeometry) {
  const auto half = arc(60, 2.0, std::numbers::pi);
  EXPECT_NEAR(bulge(half), 2.0, 1e-9) << "a semicircle bulges by its radius";
  EXPECT_NEAR(meanTurn(half), 180.0 / 60.0, 1e-9) << "a regular polygon turns alike everywhere";
  EXPECT_DOUBLE_EQ(meanTurn({half[0], half[1]}), 0.0);
  EXPECT_DOUBLE_EQ(bulge({half[0], half[1]}), 0.0);
  EXPECT_NEAR(crossTrack(half[30], {half.front(), half.back()}), 2.0, 1e-9);
  // A climb is no bulge.
  EXPECT_NEAR(bulge({{0, 0, 0}, {1, 5, 0}, {2, 0, 0}}), 0.0, 1e-12);
}

TEST(Track, ResamplingLeavesWobbleOut) {
  std::vector<Eigen::Vector3d> wobble;
  for (int i = 0; i <= 400; ++i)
    wobble.emplace_back(0.005 * i, 0.001 * (i % 2), 0.0);  // a millimetre every 5 mm
  const auto points = resampled(wobble, 0.1);
  ASSERT_GT(points.size(), 15U);
  for (std::size_t i = 1; i < points.size(); ++i)
    EXPECT_GE((points[i] - points[i - 1]).norm(), 0.1);
  EXPECT_GT(meanTurn(wobble), 20.0);
  EXPECT_LT(meanTurn(points), 1.5);
}

TEST(PathFlight, IsTheSameForTheSameSeed) {
  const experiments::Setup setup = shipped();
  const auto fly = [&](std::uint64_t trial) {
    return flyPath(setup, Primitive::kTautline, "path1", 3.0, trial, std::chrono::seconds(200),
                   true);
  };
  const nlohmann::json first = fly(0);
  EXPECT_TRUE(pathFigures(first).completed);
  EXPECT_GT(pathFigures(first).track.size(), 30U);
  EXPECT_EQ(first.dump(), fly(0).dump());
  EXPECT_NE(first.dump(), fly(1).dump()) << "other air";
}

/// The published program had no supervisor; ours has.
TEST(Stations, OnlyOursActsOnWhatTheVehicleSays) {
  const experiments::Setup setup = shipped();
  const Scene world = sceneInWorld(readScene(kConfig / "scenes/open.scene.toml"));
  for (const bool ours : {false, true}) {
    bench::Lockstep bench(setup.flight(ours ? setup.tautline : setup.as_published, world, 0),
                          nullptr);
    const auto plan = missionThrough({{0.0, 1.0, 1.5}}, 20.0);
    bool injected = false;
    bool left = false;
    const auto result =
        bench::flyMission(bench, *plan, std::chrono::seconds(150), [&](const bench::Lockstep& b) {
          const Mode mode = b.output().supervision.mode;
          if (mode == Mode::kAuto && !injected) {
            injected = true;
            sim::Fault fault = sim::makeFault("flag:MOTOR_ERROR", "on");
            fault.at = b.now();
            fault.lasting = std::chrono::seconds(3);
            bench.inject(fault);
          }
          if (injected && mode == Mode::kLand &&
              b.output().mission.state != MissionState::kCompleted)
            left = true;
        });
    EXPECT_TRUE(injected);
    EXPECT_EQ(left, ours);
    EXPECT_EQ(result.completed, !ours);
  }
}

}  // namespace
}  // namespace tautline::experiments
