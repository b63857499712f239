#include "sim_hil/dispersion.h"

#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "sim_hil/sim_config.h"
#include "sim_hil/simulator.h"
#include "sim_hil/test/flight_rig.h"

namespace tautline::sim {
namespace {

SimConfig dispersedConfig() {
  SimConfig config;
  config.vehicle.tension = 0.3;
  config.dispersion = {
      .tension = 0.06, .elevation_bias = 0.005, .azimuth_bias = 0.01, .reel_scale = 0.005};
  return config;
}

TEST(Dispersion, WithoutItEveryFlightHasTheConfiguredMachine) {
  SimConfig config;
  config.sensors.azimuth_bias = 0.01;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const SimConfig flight = dispersed(config, seed);
    EXPECT_EQ(flight.vehicle.tension, config.vehicle.tension);
    EXPECT_EQ(flight.sensors.elevation_bias, config.sensors.elevation_bias);
    EXPECT_EQ(flight.sensors.azimuth_bias, config.sensors.azimuth_bias);
    EXPECT_EQ(flight.reel.scale, config.reel.scale);
  }
}

/// Mean and standard deviation of a normal distribution cut off at two: 0 and 0.8796.
TEST(Dispersion, ScattersAboutTheConfiguredValuesWithinTwoStandardDeviations) {
  const SimConfig config = dispersedConfig();
  constexpr int kFlights = 20000;
  struct Moments {
    double sum{0.0};
    double squares{0.0};
    double largest{0.0};
    void add(double x) {
      sum += x;
      squares += x * x;
      largest = std::fmax(largest, std::abs(x));
    }
  };
  Moments tension;
  Moments elevation;
  Moments azimuth;
  Moments scale;
  double together = 0.0;  // of tension and azimuth
  for (int seed = 0; seed < kFlights; ++seed) {
    const SimConfig flight = dispersed(config, static_cast<std::uint64_t>(seed));
    const double t = (flight.vehicle.tension - 0.3) / 0.06;
    const double a = flight.sensors.azimuth_bias / 0.01;
    tension.add(t);
    azimuth.add(a);
    elevation.add(flight.sensors.elevation_bias / 0.005);
    scale.add((flight.reel.scale - 1.0) / 0.005);
    together += t * a / kFlights;
  }
  for (const Moments& m : {tension, elevation, azimuth, scale}) {
    EXPECT_NEAR(m.sum / kFlights, 0.0, 0.02);
    EXPECT_NEAR(std::sqrt(m.squares / kFlights), 0.8796, 0.02);
    EXPECT_LE(m.largest, 2.0 + 1e-9);
    EXPECT_GT(m.largest, 1.95);
  }
  EXPECT_NEAR(together, 0.0, 0.02);
}

TEST(Dispersion, TheSameSeedIsTheSameMachine) {
  const SimConfig config = dispersedConfig();
  EXPECT_EQ(dispersed(config, 7).vehicle.tension, dispersed(config, 7).vehicle.tension);
  EXPECT_NE(dispersed(config, 7).vehicle.tension, dispersed(config, 8).vehicle.tension);
}

TEST(Dispersion, IsDrawnOnce) {
  const SimConfig flight = dispersed(dispersedConfig(), 7);
  EXPECT_EQ(dispersed(flight, 7).vehicle.tension, flight.vehicle.tension);
  EXPECT_EQ(dispersed(flight, 8).reel.scale, flight.reel.scale);
}

TEST(Dispersion, IsWhatTheSimulatorFliesInTheSameAir) {
  const SimConfig config = dispersedConfig();
  SimConfig same_for_all = config;
  same_for_all.dispersion = {};
  for (const std::uint64_t seed : {3U, 4U}) {
    Simulator flight(config, emptyRoom(), seed);
    Simulator without(same_for_all, emptyRoom(), seed);
    EXPECT_EQ(flight.truth().reel_scale, dispersed(config, seed).reel.scale);
    EXPECT_NE(flight.truth().reel_scale, without.truth().reel_scale);
    flight.advanceTo(Time{} + std::chrono::seconds(1));
    without.advanceTo(Time{} + std::chrono::seconds(1));
    EXPECT_EQ(flight.truth().gust, without.truth().gust);
  }
}

TEST(Dispersion, APullIsNeverNegative) {
  SimConfig config;
  config.vehicle.tension = 0.1;
  config.dispersion.tension = 1.0;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    EXPECT_GE(dispersed(config, seed).vehicle.tension, 0.0);
}

}  // namespace
}  // namespace tautline::sim
