#include "control/descent.h"

#include <cmath>

#include <gtest/gtest.h>

#include "control/test/kinematic_plant.h"

namespace tautline {
namespace {

using testing::KinematicPlant;
using testing::kPlantStep;
using testing::PlantConfig;

const Duration kStep = fromSeconds(kPlantStep);

struct Fall {
  double aside{0.0};
  double down{0.0};
  double time{0.0};
};

Fall descendFrom(const Eigen::Vector3d& p_AD, double height, bool barometer) {
  const PlantConfig config;
  KinematicPlant plant(config, p_AD, 1);
  Descent descent;
  descent.begin(p_AD, height);
  Fall out;
  while (!descent.onGround() && out.time < 120.0) {
    const double altitude = height - (p_AD.y() - plant.position().y());
    plant.step(descent.update(kStep, 0.15, config.limits,
                              barometer ? std::optional(altitude) : std::nullopt));
    out.time += kPlantStep;
  }
  const Eigen::Vector3d moved = plant.position() - p_AD;
  out.down = -moved.y();
  out.aside = std::hypot(moved.x(), moved.z());
  return out;
}

TEST(Descent, GoesStraightDownFromEverywhere) {
  for (const double y : {0.5, 1.0, 2.0}) {
    for (const double x : {0.4, 1.0, 3.0}) {
      for (const bool barometer : {false, true}) {
        const Fall fall = descendFrom({x, y, 0.5}, y + 0.2, barometer);
        EXPECT_LT(fall.aside, 0.1) << x << ' ' << y;
        EXPECT_NEAR(fall.down, y + 0.2 + 0.3, 0.12) << x << ' ' << y;
        EXPECT_LT(fall.time, 6.0 + (y + 0.5) / 0.15);
      }
    }
  }
}

TEST(Descent, DoesNotEndWhileTheBarometerSaysThatItSinksHighUp) {
  Descent descent;
  descent.begin({1, 1, 1}, 1.2);
  double altitude = 5.0;
  for (int i = 0; i < 400; ++i) {  // 20 s: reckoned down after 10 s
    const RateCommand rates =
        descent.update(kStep, 0.15, VehicleLimits{}, altitude -= 0.1 * kPlantStep);
    EXPECT_LT(rates.elevation_rate, 0.0);
    EXPECT_FALSE(descent.onGround());
  }
  for (int i = 0; i < 200; ++i)  // stands on something
    static_cast<void>(descent.update(kStep, 0.15, VehicleLimits{}, altitude));
  EXPECT_TRUE(descent.onGround());
}

TEST(Descent, StaysWithinTheLimits) {
  Descent descent;
  descent.begin({0.05, 0.1, 0.0}, 0.3);
  const VehicleLimits limits;
  for (int i = 0; i < 400; ++i) {
    const RateCommand rates = descent.update(kStep, 0.15, limits, std::nullopt);
    EXPECT_LE(std::abs(rates.elevation_rate), limits.elevation_rate_radps + 1e-12);
    EXPECT_LE(std::abs(rates.length_rate), limits.length_rate_mps + 1e-12);
  }
  EXPECT_TRUE(descent.onGround());
}

}  // namespace
}  // namespace tautline
