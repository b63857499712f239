#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <random>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "common/testing/malloc_guard.h"
#include "estimation/localizer.h"
#include "estimation/test/flight.h"

namespace tautline {
namespace {

using testing::configFor;
using testing::deviceFlight;
using testing::Flight;
using testing::FlightGenerator;
using testing::FlightOptions;

static_assert(std::is_trivially_destructible_v<Localizer>, "owns no heap");

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(LocalizerRobustness, HoldsItsPositionOnTheGround) {
  FlightOptions o = deviceFlight(10.0);
  o.ground_time = 20.0;
  LocalizerConfig config = configFor(o);
  Flight flight(o, config);
  const Eigen::Vector3d start = flight.generator.truePosition();
  for (int i = 0; i < 900; ++i) {
    flight.step();
    ASSERT_EQ(flight.estimate.p_WD, start);
    ASSERT_EQ(flight.estimate.v_WD, Eigen::Vector3d::Zero());
  }
  EXPECT_TRUE(flight.estimate.valid);
  EXPECT_EQ(flight.estimate.health, EstimateHealth::kOk);
  EXPECT_NEAR(std::sqrt(flight.estimate.P_position(0, 0)), config.prior.position_sigma_m, 1e-12);
  flight.fly(20.0);
  EXPECT_GT((flight.estimate.p_WD - start).norm(), 0.2);
  // Landed: it stays where it came down.
  flight.generator.phase_in_flight = VehiclePhase::kIdle;
  flight.fly(0.5);
  const Eigen::Vector3d landed = flight.estimate.p_WD;
  flight.fly(5.0);
  EXPECT_EQ(flight.estimate.p_WD, landed);
}

TEST(LocalizerRobustness, IsInvalidUntilReset) {
  Localizer localizer{LocalizerConfig{}};
  const Estimate e = localizer.update(Time{}, SensorFrame{}, VehicleCommand{}, Anchor{});
  EXPECT_FALSE(e.valid);
  EXPECT_EQ(e.health, EstimateHealth::kLost);
}

TEST(LocalizerRobustness, SilenceDegradesThenLosesThenRecovers) {
  for (const double rate : {10.0, 1.0}) {
    const FlightOptions o = deviceFlight(rate);
    Flight flight(o, configFor(o));
    flight.fly(30.0);
    ASSERT_EQ(flight.estimate.health, EstimateHealth::kOk) << rate;
    const double sigma_before = flight.estimate.P_position.trace();
    flight.generator.silent = true;
    std::vector<EstimateHealth> seen;
    for (int i = 0; i < static_cast<int>(15.0 / FlightGenerator::kCycle); ++i) {
      flight.step();
      if (seen.empty() || seen.back() != flight.estimate.health)
        seen.push_back(flight.estimate.health);
    }
    EXPECT_EQ(seen,
              (std::vector{EstimateHealth::kOk, EstimateHealth::kDegraded, EstimateHealth::kLost}))
        << rate;
    EXPECT_GT(flight.estimate.P_position.trace(), 3.0 * sigma_before);
    flight.generator.silent = false;
    flight.fly(12.0);
    EXPECT_EQ(flight.estimate.health, EstimateHealth::kOk) << rate;
    EXPECT_LT(flight.fly(10.0).worst, 0.35) << rate;
  }
}

TEST(LocalizerRobustness, RefusesOutliersAndReacquiresAfterAJump) {
  FlightOptions o = deviceFlight(10.0);
  o.moving = false;
  Flight flight(o, configFor(o));
  flight.fly(20.0);
  const Eigen::Vector3d before = flight.estimate.p_WD;
  // One sample is two metres off: it contradicts the one before.
  flight.generator.silent = true;
  SensorFrame& frame = flight.generator.frame();
  ++frame.reel.sequence;
  frame.reel.time = flight.generator.now();
  frame.reel.value.length += 2.0;
  flight.step();
  EXPECT_LT((flight.estimate.p_WD - before).norm(), 0.02);
  EXPECT_LT(flight.estimate.nis, 2.0);
  // All samples are off: after a while the filter believes them.
  EstimateHealth worst = EstimateHealth::kOk;
  for (int i = 0; i < 200; ++i) {
    if (i % 5 == 0) {
      for (auto* sequence :
           {&frame.reel.sequence, &frame.angles.sequence, &frame.attitude.sequence})
        ++*sequence;
      frame.reel.time = frame.angles.time = frame.attitude.time = flight.generator.now();
    }
    flight.step();
    worst = std::max(worst, flight.estimate.health);
  }
  EXPECT_EQ(worst, EstimateHealth::kLost);
  EXPECT_GT((flight.estimate.p_WD - before).norm(), 1.0);
}

TEST(LocalizerRobustness, LearnsNothingFromNoise) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    FlightOptions o = deviceFlight(20.0);
    o.moving = false;
    o.seed = seed;
    Flight flight(o, configFor(o));
    flight.fly(20.0);
    const Estimate before = flight.estimate;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> anything(0.0, 50.0);
    std::uint32_t sequence = 0;
    double length = 0.0;
    for (int i = 0; i < static_cast<int>(5.0 / FlightGenerator::kCycle); ++i) {
      flight.generator.step();
      SensorFrame frame = flight.generator.frame();
      if (frame.reel.sequence != sequence) length = anything(random);
      sequence = frame.reel.sequence;
      frame.reel.value.length = length;
      flight.estimate = flight.localizer.update(
          flight.generator.now(), frame, flight.generator.lastCommand(), flight.generator.anchor());
    }
    flight.fly(3.0);
    EXPECT_LT(flight.fly(5.0).worst, 0.15) << seed;
    EXPECT_NEAR(flight.estimate.reel_scale, before.reel_scale, 0.01) << seed;
    EXPECT_NEAR(flight.estimate.elevation_bias, before.elevation_bias, 0.01) << seed;
  }
}

TEST(LocalizerRobustness, NothingNotFiniteEverComesOut) {
  const FlightOptions o = deviceFlight(10.0);
  Flight flight(o, configFor(o));
  flight.fly(10.0);
  for (int i = 0; i < 400; ++i) {
    flight.generator.step();
    SensorFrame frame = flight.generator.frame();
    VehicleCommand command = flight.generator.lastCommand();
    Anchor anchor = flight.generator.anchor();
    switch (i % 8) {
      case 0:
        frame.reel.value.length = kNan;
        break;
      case 1:
        frame.angles.value.theta = kNan;
        break;
      case 2:
        frame.angles.value.phi = -1e300;
        break;
      case 3:
        frame.attitude.value.R_WB.coeffs().setConstant(kNan);
        break;
      case 4:
        command.length_rate = kNan;
        break;
      case 5:
        command.azimuth_rate = std::numeric_limits<double>::infinity();
        break;
      case 6:
        anchor.p_WA.x() = kNan;
        break;
      default:
        frame.angles.value.altitude = kNan;
        break;
    }
    const Estimate e = flight.localizer.update(flight.generator.now(), frame, command, anchor);
    ASSERT_TRUE(Flight::isFinite(e)) << i;
  }
  EXPECT_LT(flight.fly(10.0).worst, 0.3);
}

TEST(LocalizerRobustness, TimeThatStandsStillOrGoesBackChangesNothing) {
  const FlightOptions o = deviceFlight(10.0);
  Flight flight(o, configFor(o));
  flight.fly(10.0);
  const Time now = flight.generator.now();
  const auto again = [&](Time t) {
    return flight.localizer.update(t, flight.generator.frame(), flight.generator.lastCommand(),
                                   flight.generator.anchor());
  };
  EXPECT_EQ(again(now).p_WD, flight.estimate.p_WD);
  EXPECT_EQ(again(now - fromSeconds(3.0)).p_WD, flight.estimate.p_WD);
  // A sample with a new number but an old time is not news.
  ++flight.generator.frame().reel.sequence;
  flight.generator.frame().reel.time -= fromSeconds(1.0);
  flight.generator.frame().reel.value.length += 0.2;
  EXPECT_EQ(again(now).p_WD, flight.estimate.p_WD);
}

TEST(LocalizerRobustness, SurvivesTheAnchorAndTheVertical) {
  const LocalizerConfig config;
  for (const double L : {0.0, 0.001, 0.05, 3.0}) {
    for (const double theta : {-std::numbers::pi / 2, 0.0, 1.5707, std::numbers::pi / 2}) {
      Localizer localizer(config);
      localizer.reset(Eigen::Vector3d::Zero(), Time{});
      SensorFrame frame;
      frame.vehicle = {.time = {}, .sequence = 1, .valid = true, .value = {}};
      frame.vehicle.value.phase = VehiclePhase::kFlying;
      VehicleCommand command;
      command.engaged = true;
      command.elevation_rate = 0.2;
      for (int i = 1; i < 300; ++i) {
        const Time now = Time{} + fromSeconds(0.02 * i);
        if (i % 5 == 0) {
          const auto sequence = static_cast<std::uint32_t>(i);
          frame.reel = {now, sequence, true, ReelReading{.counts = 0, .length = L, .tension = {}}};
          frame.angles = {now, sequence, true,
                          TetherAngles{.theta = theta, .phi = 3.1, .altitude = {}}};
          frame.attitude = {now, sequence, true, AttitudeReading{}};
        }
        ASSERT_TRUE(Flight::isFinite(localizer.update(now, frame, command, Anchor{})))
            << L << " " << theta;
      }
    }
  }
}

TEST(LocalizerRobustness, IsDeterministic) {
  const FlightOptions o = deviceFlight(10.0);
  Flight a(o, configFor(o));
  Flight b(o, configFor(o));
  for (int i = 0; i < 1000; ++i) {
    a.step();
    b.step();
    ASSERT_EQ(a.estimate.p_WD, b.estimate.p_WD);
    ASSERT_EQ(a.estimate.P_position, b.estimate.P_position);
  }
}

TEST(LocalizerRobustness, DoesNotAllocate) {
  if (!testing::MallocGuard::available()) GTEST_SKIP() << "the sanitizer owns malloc in this build";
  struct Cycle {
    Time now;
    SensorFrame frame;
    VehicleCommand command;
  };
  const FlightOptions o = deviceFlight(10.0);
  FlightGenerator generator(o);
  const Eigen::Vector3d start = generator.truePosition();
  std::vector<Cycle> flight;
  for (int i = 0; i < 10000; ++i) {
    generator.step();
    flight.push_back({generator.now(), generator.frame(), generator.lastCommand()});
  }
  for (const auto& entry : kLocalizerVariantNames) {
    LocalizerConfig config = configFor(o);
    config.variant = entry.value;
    Localizer localizer(config);
    const testing::MallocGuard guard;
    localizer.reset(start, Time{});
    for (const Cycle& c : flight) {
      static_cast<void>(localizer.update(c.now, c.frame, c.command, Anchor{}));
    }
    EXPECT_EQ(guard.allocations(), 0) << entry.name;
  }
  const testing::MallocGuard guard;
  void* volatile block = std::malloc(16);
  std::free(block);
  EXPECT_EQ(guard.allocations(), 1) << "the guard itself counts";
}

}  // namespace
}  // namespace tautline
