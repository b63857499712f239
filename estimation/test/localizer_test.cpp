#include "estimation/localizer.h"

#include <cmath>

#include <gtest/gtest.h>

#include "estimation/test/flight.h"

namespace tautline {
namespace {

using testing::configFor;
using testing::deviceFlight;
using testing::Flight;
using testing::FlightGenerator;
using testing::FlightOptions;

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
    LocalizerConfig config = configFor(o);
    config.noise.altitude_correlation_time_s = 0.0;  // a barometer that does not drift
    config.noise.altitude_sigma_m = o.altitude_sigma;
    Flight flight(o, config);
    flight.fly(120.0);
    EXPECT_NEAR(flight.estimate.reel_scale, scale, 0.02);
    EXPECT_LT(flight.estimate.sigma_reel_scale, 0.03);
    const double with_altitude = flight.fly(30.0).mean;

    LocalizerConfig blind = config;
    blind.prior.reel_scale_sigma = 0.0;
    blind.process.reel_scale_drift = 0.0;
    Flight fixed_scale(o, blind);
    fixed_scale.fly(120.0);
    EXPECT_LT(with_altitude, 0.7 * fixed_scale.fly(30.0).mean);
  }
}

TEST(Localizer, DoesNotInventAReelScale) {
  // Length, angles and commanded rates are those of any other scale too: only the sag tells, a
  // little.
  FlightOptions o = deviceFlight(10.0);
  o.has_altitude = false;
  o.reel_scale = 1.05;
  LocalizerConfig config = configFor(o);
  config.prior.reel_scale_sigma = 0.05;
  config.process.reel_scale_drift = 0.0;
  config.prior.parked_slack_sigma_m = 10.0;  // what home tells is not what is tested here
  Flight flight(o, config);
  flight.fly(180.0);
  EXPECT_GT(flight.estimate.sigma_reel_scale, 0.04);
  EXPECT_NEAR(flight.estimate.reel_scale, 1.0, 0.03);
  EXPECT_LT(std::abs(flight.estimate.reel_scale - 1.05), 2.0 * flight.estimate.sigma_reel_scale);
}

TEST(Localizer, FindsAnElevationBias) {
  FlightOptions o = deviceFlight(10.0);
  o.elevation_bias = 0.05;
  LocalizerConfig config = configFor(o);
  config.prior.elevation_bias_sigma_rad = 0.05;
  config.prior.reel_scale_sigma = 0.005;
  config.noise.altitude_correlation_time_s = 0.0;
  config.noise.altitude_sigma_m = o.altitude_sigma;
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
    // However long it hovers, the error of the contacts stays in.
    EXPECT_GT(flight.estimate.P_position.trace() - before, 0.9 * added) << contacts;
    EXPECT_LT(flight.estimate.P_position.trace() - before, 2.0 * added) << contacts;
  }
  EXPECT_LT((flight.estimate.p_WD - flight.generator.truePosition()).norm(), 0.15);
  EXPECT_EQ(flight.estimate.health, EstimateHealth::kOk);
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

}  // namespace
}  // namespace tautline
