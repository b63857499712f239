#include "estimation/localizer.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "common/testing/malloc_guard.h"
#include "estimation/test/flight_generator.h"

namespace tautline {
namespace {

using testing::FlightGenerator;
using testing::FlightOptions;

static_assert(std::is_trivially_destructible_v<Localizer>, "owns no heap");

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The reference device: 0.01 rad, 2.85 mm a count.
FlightOptions deviceFlight(double rate) {
  FlightOptions o;
  o.rate = rate;
  o.angle_quantum = 0.01;
  o.length_quantum = 0.00285;
  o.altitude_sigma = 0.1;
  o.lean_sigma = 0.02;
  o.velocity_sigma = 0.05;
  return o;
}

LocalizerConfig configFor(const FlightOptions& o) {
  LocalizerConfig config;
  config.nominal_tension_n = o.T_nominal;
  return config;
}

/// A localizer that follows a generated flight.
class Flight {
 public:
  Flight(const FlightOptions& options, const LocalizerConfig& config)
      : generator(options), localizer(config) {
    localizer.reset(generator.truePosition(), generator.now());
  }

  Estimate step() {
    generator.step();
    estimate = localizer.update(generator.now(), generator.frame(), generator.lastCommand(),
                                generator.anchor());
    return estimate;
  }

  struct Errors {
    double mean{0.0};
    double worst{0.0};
  };
  /// Flies on; errors of position against truth, once every ten cycles.
  Errors fly(double seconds) {
    Errors errors;
    int count = 0;
    const int cycles = static_cast<int>(seconds / FlightGenerator::kCycle);
    for (int i = 0; i < cycles; ++i) {
      step();
      EXPECT_TRUE(isFinite(estimate));
      if (i % 10 != 0) continue;
      const double error = (estimate.p_WD - generator.truePosition()).norm();
      errors.mean += error;
      errors.worst = std::fmax(errors.worst, error);
      ++count;
    }
    errors.mean /= count;
    return errors;
  }

  static bool isFinite(const Estimate& e) {
    return e.p_WD.allFinite() && e.v_WD.allFinite() && e.P_position.allFinite() &&
           std::isfinite(e.L_free) && std::isfinite(e.theta_tangent) && std::isfinite(e.phi) &&
           std::isfinite(e.T) && std::isfinite(e.sigma_T) && std::isfinite(e.nis);
  }

  FlightGenerator generator;
  Localizer localizer;
  Estimate estimate;
};

TEST(Localizer, FollowsTheReferenceDeviceAt10Hz) {
  const FlightOptions o = deviceFlight(10.0);
  Flight flight(o, configFor(o));
  flight.fly(5.0);
  const Flight::Errors errors = flight.fly(60.0);
  EXPECT_LT(errors.mean, 0.06);
  EXPECT_LT(errors.worst, 0.20);
  EXPECT_EQ(flight.estimate.health, EstimateHealth::kOk);
}

TEST(Localizer, StaysUsableAt1Hz) {
  const FlightOptions o = deviceFlight(1.0);
  Flight flight(o, configFor(o));
  flight.fly(10.0);
  const Flight::Errors errors = flight.fly(60.0);
  EXPECT_LT(errors.mean, 0.10);
  EXPECT_LT(errors.worst, 0.30);
  EXPECT_EQ(flight.estimate.health, EstimateHealth::kOk);
}

TEST(Localizer, KnowsTheAgeOfItsSamples) {
  FlightOptions o = deviceFlight(10.0);
  o.latency = 0.3;
  o.velocity_sigma = 0.0;
  Flight flight(o, configFor(o));
  flight.fly(5.0);
  const double aware = flight.fly(60.0).mean;

  // The same readings with their time of arrival for their time.
  FlightGenerator generator(o);
  Localizer localizer(configFor(o));
  localizer.reset(generator.truePosition(), generator.now());
  double naive = 0.0;
  int count = 0;
  for (int i = 0; i < 3250; ++i) {
    generator.step();
    SensorFrame frame = generator.frame();
    frame.reel.time += fromSeconds(o.latency);
    frame.angles.time += fromSeconds(o.latency);
    const Estimate e =
        localizer.update(generator.now(), frame, generator.lastCommand(), generator.anchor());
    if (i > 250 && i % 10 == 0) {
      naive += (e.p_WD - generator.truePosition()).norm();
      ++count;
    }
  }
  EXPECT_LT(aware, 0.75 * naive / count);
}

TEST(Localizer, FindsAReelScaleErrorByHeight) {
  for (const double scale : {1.05, 0.95}) {
    FlightOptions o = deviceFlight(10.0);
    o.reel_scale = scale;
    Flight flight(o, configFor(o));
    flight.fly(120.0);
    EXPECT_NEAR(flight.estimate.reel_scale, scale, 0.02);
    EXPECT_LT(flight.estimate.sigma_reel_scale, 0.03);
    const double with_altitude = flight.fly(30.0).mean;

    LocalizerConfig blind = configFor(o);
    blind.prior.reel_scale_sigma = 0.0;
    blind.process.reel_scale_drift = 0.0;
    Flight fixed_scale(o, blind);
    fixed_scale.fly(120.0);
    EXPECT_LT(with_altitude, 0.7 * fixed_scale.fly(30.0).mean);
  }
}

TEST(Localizer, FindsAnElevationBias) {
  FlightOptions o = deviceFlight(10.0);
  o.elevation_bias = 0.05;
  LocalizerConfig config = configFor(o);
  config.prior.elevation_bias_sigma_rad = 0.05;
  config.prior.reel_scale_sigma = 0.005;
  Flight flight(o, config);
  flight.fly(120.0);
  EXPECT_NEAR(flight.estimate.elevation_bias, 0.05, 0.025);
}

TEST(Localizer, FindsTheTensionFromLeanOrReel) {
  for (const bool by_reel : {false, true}) {
    FlightOptions o = deviceFlight(10.0);
    o.T_nominal = 1.6;
    o.steepest = 0.9;
    o.has_attitude = !by_reel;
    o.has_reel_tension = by_reel;
    LocalizerConfig config = configFor(o);
    config.nominal_tension_n = 0.7;  // wrong by more than a factor of two
    Flight flight(o, config);
    flight.fly(40.0);
    EXPECT_NEAR(flight.estimate.T, 1.6, 0.45) << by_reel;
    EXPECT_LT(std::abs(flight.estimate.T - 1.6), 3.0 * flight.estimate.sigma_T) << by_reel;
  }
}

TEST(Localizer, FallsBackToTheNominalTension) {
  FlightOptions o = deviceFlight(10.0);
  o.has_attitude = false;
  Flight flight(o, configFor(o));
  flight.fly(40.0);
  EXPECT_NEAR(flight.estimate.T, o.T_nominal, 0.3);
  EXPECT_EQ(flight.estimate.health, EstimateHealth::kDegraded);
}

TEST(Localizer, PassesOverThePole) {
  FlightOptions o = deviceFlight(10.0);
  o.steepest = 1.565;
  Flight flight(o, configFor(o));
  flight.fly(5.0);
  const Flight::Errors errors = flight.fly(60.0);
  EXPECT_LT(errors.mean, 0.08);
  EXPECT_LT(errors.worst, 0.30);
}

TEST(Localizer, HoldsItsPositionOnTheGround) {
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

TEST(Localizer, IsInvalidUntilReset) {
  Localizer localizer{LocalizerConfig{}};
  const Estimate e = localizer.update(Time{}, SensorFrame{}, VehicleCommand{}, Anchor{});
  EXPECT_FALSE(e.valid);
  EXPECT_EQ(e.health, EstimateHealth::kLost);
}

TEST(Localizer, SilenceDegradesThenLosesThenRecovers) {
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

TEST(Localizer, RefusesOutliersAndReacquiresAfterAJump) {
  FlightOptions o = deviceFlight(10.0);
  o.moving = false;
  Flight flight(o, configFor(o));
  flight.fly(20.0);
  const Eigen::Vector3d before = flight.estimate.p_WD;
  // One sample is two metres off.
  flight.generator.silent = true;
  SensorFrame& frame = flight.generator.frame();
  ++frame.reel.sequence;
  frame.reel.time = flight.generator.now();
  frame.reel.value.length += 2.0;
  flight.step();
  EXPECT_LT((flight.estimate.p_WD - before).norm(), 0.02);
  EXPECT_GT(flight.estimate.nis, 2.0);
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

TEST(Localizer, CovarianceGrowsWithEachContact) {
  FlightOptions o = deviceFlight(10.0);
  o.moving = false;
  const LocalizerConfig config = configFor(o);
  Flight flight(o, config);
  flight.fly(30.0);
  const double before = flight.estimate.P_position.trace();
  Anchor anchor;
  for (int contacts = 1; contacts <= 3; ++contacts) {
    anchor.contact_count = contacts;
    anchor.p_WA += Eigen::Vector3d(0.01, 0.0, 0.01);
    anchor.L_static += 0.5;
    flight.generator.setAnchor(anchor);
    flight.fly(20.0);
    const double added = 3.0 * contacts * std::pow(config.prior.contact_sigma_m, 2);
    EXPECT_NEAR(flight.estimate.P_position.trace() - before, added, 0.3 * added + 0.1 * before)
        << contacts;
  }
  EXPECT_LT((flight.estimate.p_WD - flight.generator.truePosition()).norm(), 0.15);
  EXPECT_EQ(flight.estimate.health, EstimateHealth::kOk);
}

TEST(Localizer, NothingNotFiniteEverComesOut) {
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

TEST(Localizer, TimeThatStandsStillOrGoesBackChangesNothing) {
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

TEST(Localizer, SurvivesTheAnchorAndTheVertical) {
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

TEST(Localizer, PublishedVariantsAreTheMemorylessFixItself) {
  for (const auto& entry : kLocalizerVariantNames) {
    const auto fix_variant = fixOf(entry.value);
    if (!fix_variant || *fix_variant == FixVariant::kExact)
      continue;  // exact needs a tension of its own
    const FlightOptions o = deviceFlight(10.0);
    LocalizerConfig config = configFor(o);
    config.variant = entry.value;
    Flight flight(o, config);
    flight.fly(2.0);
    for (int i = 0; i < 500; ++i) {
      flight.step();
      const SensorFrame& frame = flight.generator.frame();
      const LeanForces lean =
          forcesFromLean(thrustElevation(frame.attitude.value.R_WB), frame.angles.value.theta, o.G);
      const PositionFix fix = fixPosition(
          *fix_variant,
          {frame.reel.value.length, frame.angles.value.theta, frame.angles.value.phi, lean.T, o.w});
      if (fix.ok) {
        ASSERT_EQ(flight.estimate.p_WD, fix.p_AD) << entry.name;
      }
    }
    EXPECT_TRUE(flight.estimate.valid);
  }
}

TEST(Localizer, FilterBeatsEveryMemorylessVariant) {
  const FlightOptions o = [] {
    FlightOptions f = deviceFlight(1.0);
    f.T_nominal = 0.5;
    return f;
  }();
  const auto mean = [&](LocalizerVariant variant) {
    LocalizerConfig config = configFor(o);
    config.variant = variant;
    Flight flight(o, config);
    flight.fly(10.0);
    return flight.fly(60.0).mean;
  };
  const double filter = mean(LocalizerVariant::kFilter);
  for (const auto& entry : kLocalizerVariantNames) {
    if (entry.value != LocalizerVariant::kFilter) {
      EXPECT_LT(filter, 0.7 * mean(entry.value)) << entry.name;
    }
  }
}

TEST(Localizer, IsDeterministic) {
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

TEST(Localizer, DoesNotAllocate) {
  if (!testing::MallocGuard::available()) GTEST_SKIP() << "the sanitizer owns malloc in this build";
  const FlightOptions o = deviceFlight(10.0);
  for (const auto& entry : kLocalizerVariantNames) {
    LocalizerConfig config = configFor(o);
    config.variant = entry.value;
    FlightGenerator generator(o);
    Localizer localizer(config);
    const testing::MallocGuard guard;
    localizer.reset(generator.truePosition(), generator.now());
    for (int i = 0; i < 1000; ++i) {
      generator.step();
      static_cast<void>(localizer.update(generator.now(), generator.frame(),
                                         generator.lastCommand(), generator.anchor()));
    }
    EXPECT_EQ(guard.allocations(), 0) << entry.name;
  }
}

}  // namespace
}  // namespace tautline
