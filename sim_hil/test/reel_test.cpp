#include "sim_hil/reel.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace tautline::sim {
namespace {

constexpr double kStep = 0.002;

double rateFor(double command) {
  ReelConfig config;
  config.max_length = 1000.0;
  Reel reel(config, 500.0);
  reel.command(command);
  for (int i = 0; i < 4000; ++i) reel.step(kStep, 0.0);
  return reel.rate() / config.metres_per_count;
}

TEST(Reel, NothingMovesInTheDeadZone) {
  for (const double command : {-199.0, -180.0, -160.0, -140.0, -121.0}) {
    EXPECT_EQ(rateFor(command), 0.0) << command;
  }
}

TEST(Reel, OutsideTheDeadZoneTheRateIsAsCommanded) {
  for (const double command : {-400.0, -201.0, -200.0, -120.0, -60.0, 0.0, 60.0, 160.0, 400.0}) {
    EXPECT_NEAR(rateFor(command), command, 0.01) << command;
  }
}

TEST(Reel, CommandsAreCutToTheDevicesLimitAndNanStands) {
  EXPECT_NEAR(rateFor(10000.0), rateFor(50000.0), 1e-9);
  EXPECT_EQ(rateFor(std::numeric_limits<double>::quiet_NaN()), 0.0);
}

TEST(Reel, StopsAtBothEnds) {
  ReelConfig config;
  config.max_length = 2.0;
  Reel reel(config, 1.0);
  reel.command(1000.0);
  for (int i = 0; i < 5000; ++i) reel.step(kStep, 0.0);
  EXPECT_EQ(reel.length(), 2.0);
  EXPECT_EQ(reel.rate(), 0.0);
  reel.command(-1000.0);
  for (int i = 0; i < 5000; ++i) reel.step(kStep, 0.0);
  EXPECT_EQ(reel.length(), config.min_length);
}

TEST(Reel, FollowsWithItsLag) {
  ReelConfig config;
  config.max_acceleration = 100.0;
  Reel reel(config, 1.0);
  reel.command(100.0);
  const double wanted = 100.0 * config.metres_per_count;
  for (int i = 0; i < 50; ++i) reel.step(kStep, 0.0);  // one time constant
  EXPECT_NEAR(reel.rate() / wanted, 1.0 - std::exp(-1.0), 0.01);
}

TEST(Reel, LockedItHoldsUnlessThePullIsTooStrong) {
  ReelConfig config;
  Reel reel(config, 1.0);
  reel.command(100.0);
  reel.lock(true);
  for (int i = 0; i < 1000; ++i) reel.step(kStep, 0.9 * config.slip_tension);
  EXPECT_EQ(reel.length(), 1.0);
  const auto counts = reel.counts();
  for (int i = 0; i < 100; ++i) reel.step(kStep, 1.5 * config.slip_tension);
  EXPECT_GT(reel.length(), 1.05);
  EXPECT_GT(reel.counts(), counts);  // the encoder sees the slip
}

TEST(Reel, CountsAreWholeAndTruePerScale) {
  ReelConfig config;
  config.scale = 1.25;
  config.power_on_length = 0.5;
  const Reel reel(config, 1.0);
  EXPECT_EQ(reel.counts(), static_cast<std::int64_t>(std::floor(0.5 / (0.00285 * 1.25))));
}

TEST(Reel, CountsOfAThinningDrumAreTheIntegralOverItsLayers) {
  ReelConfig config;
  config.scale = 1.1;
  config.layer = 0.02;
  config.power_on_length = 0.3;
  const Reel reel(config, 6.0);
  double counts = 0.0;
  constexpr double kPiece = 1e-5;
  for (double out = config.power_on_length + 0.5 * kPiece; out < 6.0; out += kPiece)
    counts += kPiece / (0.00285 * 1.1 * (1.0 - 0.02 * out));
  EXPECT_NEAR(static_cast<double>(reel.counts()), counts, 1.0);
  EXPECT_NEAR(reel.metresPerCount(), 0.00285 * 1.1 * (1.0 - 0.02 * 6.0), 1e-12);
  EXPECT_LT(reel.scale(), 1.1);
  EXPECT_GT(reel.scale(), 1.1 * (1.0 - 0.02 * 6.0));
}

TEST(Reel, ThinningDrumDrivesAtTheCommandedCounts) {
  ReelConfig config;
  config.layer = 0.02;
  Reel reel(config, 5.0);
  reel.command(100.0);
  for (int i = 0; i < 1000; ++i) reel.step(kStep, 0.0);
  const auto before = reel.counts();
  for (int i = 0; i < 500; ++i) {
    reel.command(100.0);
    reel.step(kStep, 0.0);
  }
  EXPECT_NEAR(static_cast<double>(reel.counts() - before), 100.0, 2.0);
}

/// The tether as a spring: the drum finds the length at which it pulls as hard as it should.
TEST(Reel, HoldsItsTensionWhateverTheLength) {
  ReelConfig config;
  config.mode = ReelMode::kTension;
  config.tension = 2.0;
  Reel reel(config, 1.0);
  constexpr double kStiffness = 20.0;  // [N/m]
  constexpr double kReach = 1.4;       // [m]
  const auto pull = [&] { return std::fmax(0.0, kStiffness * (kReach - reel.length())); };
  for (int i = 0; i < 5000; ++i) reel.step(kStep, pull());
  EXPECT_NEAR(pull(), 2.0, 1e-3);
  reel.lock(true);
  const double length = reel.length();
  for (int i = 0; i < 1000; ++i) reel.step(kStep, 0.5);
  EXPECT_EQ(reel.length(), length);
}

}  // namespace
}  // namespace tautline::sim
