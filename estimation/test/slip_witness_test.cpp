#include "estimation/slip_witness.h"

#include <optional>
#include <random>

#include <gtest/gtest.h>

namespace tautline {
namespace {

constexpr double kCycle = 0.01;  // [s]

/// A barometer at a contact: white noise over an offset that nobody knows, and what drifts.
struct Barometer {
  explicit Barometer(std::uint32_t seed) : random(seed) {}

  /// Runs for `seconds`; when a slip was told, from their begin.
  std::optional<double> run(double seconds) {
    std::optional<double> told;
    for (int i = 0; i * kCycle < seconds; ++i) {
      now += fromSeconds(kCycle);
      offset += drift * kCycle;
      if (cycle++ % every == 0) {
        ++sequence;
        reading = offset + noise * normal(random);
      }
      witness.update(now, sequence, reading);
      if (witness.slipped() && !told) told = i * kCycle;
    }
    return told;
  }

  SlipWitness witness{SlipWitnessConfig{}};
  std::mt19937 random;
  std::normal_distribution<double> normal{};
  double noise{0.1};   // [m]
  double drift{0.0};   // [m/s]
  double offset{1.5};  // [m]
  int every{4};        // cycles
  Time now{};
  int cycle{0};
  std::uint32_t sequence{0};
  double reading{0.0};
};

TEST(SlipWitness, TellsASlipEitherWaySoonAndKeepsIt) {
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    for (const double slip : {0.3, -0.3}) {
      Barometer b(seed);
      ASSERT_EQ(b.run(10.0), std::nullopt) << seed;
      b.offset += slip;
      const auto told = b.run(2.0);
      ASSERT_TRUE(told) << seed;
      EXPECT_LT(*told, 1.0) << seed;
      EXPECT_NEAR(b.witness.slip(), slip, 0.12) << seed;
      b.run(60.0);
      EXPECT_TRUE(b.witness.slipped()) << "a slip that lasts is no drift";
      EXPECT_NEAR(b.witness.slip(), slip, 0.12) << seed;
      b.witness.restart();
      EXPECT_EQ(b.run(10.0), std::nullopt) << "made anew where it is";
    }
  }
}

TEST(SlipWitness, WhatIsFarBelowASlipIsNotTold) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Barometer b(seed);
    ASSERT_EQ(b.run(10.0), std::nullopt);
    b.offset += 0.05;
    EXPECT_EQ(b.run(60.0), std::nullopt) << seed;
  }
}

TEST(SlipWitness, TakesNoiseAndDriftForNothingElse) {
  int alarms = 0;
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    Barometer b(seed);
    b.drift = seed % 2 == 0 ? 0.003 : -0.003;
    alarms += b.run(600.0) ? 1 : 0;
  }
  EXPECT_LE(alarms, 3) << "in 10 hours; 0.1 an hour promised";
}

TEST(SlipWitness, SlowReadingsAreNoWeaker) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Barometer b(seed);
    b.every = 100;
    b.noise = 0.05;
    ASSERT_EQ(b.run(20.0), std::nullopt) << seed;
    b.offset += 0.4;
    const auto told = b.run(10.0);
    ASSERT_TRUE(told) << seed;
    EXPECT_GT(*told, 0.5) << seed;
  }
}

TEST(SlipWitness, AnOldReadingIsNoNewEvidence) {
  Barometer b(1);
  b.noise = 0.0;
  b.run(10.0);
  b.offset += 0.4;
  b.run(4 * kCycle);
  const double once = b.witness.evidence();
  EXPECT_GT(once, 0.0);
  EXPECT_LT(once, 1.0);
  b.every = 1'000'000;
  b.cycle = 1;
  b.run(10.0);
  EXPECT_EQ(b.witness.evidence(), once);
}

TEST(SlipWitness, NothingIsJudgedBeforeTheMeanIsSettled) {
  Barometer b(1);
  b.noise = 0.0;
  b.run(0.5);
  b.offset += 5.0;
  b.run(0.4);
  EXPECT_EQ(b.witness.evidence(), 0.0);
}

}  // namespace
}  // namespace tautline
