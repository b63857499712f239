#include <cmath>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "estimation/localizer.h"
#include "estimation/test/flight_generator.h"

/// Is the covariance honest? Flights are drawn from the filter's own assumptions (priors, noise,
/// process), and the error of the estimate, normalized by the covariance that goes with it, is
/// compared with the chi-square distribution it then has.

namespace tautline {
namespace {

using testing::FlightGenerator;
using testing::FlightOptions;

constexpr int kFlights = 60;

struct Consistency {
  double nees{0.0};   ///< Normalized estimation error squared of position, 3 degrees of freedom,
                      ///< mean over flights.
  double scale{0.0};  ///< The same for the reel's scale, 1 degree of freedom.
  double mean_error{0.0};  ///< [m]
};

LocalizerConfig whiteNoiseConfig() {
  LocalizerConfig config;
  config.nominal_tension_n = 1.0;
  config.process.tension_sigma = 0.2;
  config.noise.correlation_time_s = 0.0;
  config.noise.altitude_correlation_time_s = 0.0;
  config.noise.tension_correlation_time_s = 0.0;
  config.noise.altitude_sigma_m = 0.2;
  return config;
}

FlightOptions drawFlight(const LocalizerConfig& config, double rate, std::uint32_t seed) {
  std::mt19937 random(1000 + seed);
  std::normal_distribution<double> normal;
  FlightOptions o;
  o.seed = seed;
  o.rate = rate;
  o.steepest = 1.0;
  o.T_nominal = config.nominal_tension_n;
  o.tension_sigma = config.process.tension_sigma;
  o.tension_time_constant = config.process.tension_time_constant_s;
  o.velocity_sigma = config.process.velocity_sigma_mps;
  o.velocity_time_constant = config.process.velocity_time_constant_s;
  o.length_sigma = config.noise.length_sigma_m;
  o.angle_sigma = config.noise.elevation_sigma_rad;
  o.altitude_sigma = config.noise.altitude_sigma_m;
  o.lean_sigma = config.noise.lean_sigma_rad;
  o.reel_scale = 1.0 + config.prior.reel_scale_sigma * normal(random);
  o.elevation_bias = config.prior.elevation_bias_sigma_rad * normal(random);
  o.azimuth_zero = config.prior.azimuth_zero_sigma_rad * normal(random);
  return o;
}

Consistency measure(const LocalizerConfig& config, double rate, double seconds) {
  Consistency out;
  for (std::uint32_t seed = 0; seed < kFlights; ++seed) {
    const FlightOptions o = drawFlight(config, rate, seed);
    FlightGenerator generator(o);
    Localizer localizer(config);
    localizer.reset(generator.truePosition(), generator.now());
    Estimate estimate;
    const int cycles = static_cast<int>(seconds / FlightGenerator::kCycle);
    for (int i = 0; i < cycles; ++i) {
      generator.step();
      estimate = localizer.update(generator.now(), generator.frame(), generator.lastCommand(),
                                  generator.anchor());
    }
    const Eigen::Vector3d error = estimate.p_WD - generator.truePosition();
    out.nees += error.dot(estimate.P_position.ldlt().solve(error)) / kFlights;
    out.scale +=
        std::pow((estimate.reel_scale - o.reel_scale) / estimate.sigma_reel_scale, 2) / kFlights;
    out.mean_error += error.norm() / kFlights;
  }
  return out;
}

// Mean of n chi-square variables of k degrees of freedom: k +- z sqrt(2k/n); z = 3.3 is 99.9 % on
// each side.
double spread(int k) { return 3.3 * std::sqrt(2.0 * k / kFlights); }

class LocalizerConsistency : public ::testing::TestWithParam<double> {};

TEST_P(LocalizerConsistency, ErrorsAreAsLargeAsTheCovarianceSays) {
  for (const double seconds : {6.0, 25.0, 60.0}) {
    const Consistency got = measure(whiteNoiseConfig(), GetParam(), seconds);
    RecordProperty("nees", std::to_string(got.nees));
    EXPECT_GT(got.nees, 3.0 - spread(3)) << seconds << " s";
    EXPECT_LT(got.nees, 3.0 + spread(3)) << seconds << " s";
    EXPECT_LT(got.scale, 1.0 + spread(1)) << seconds << " s";
    EXPECT_LT(got.mean_error, 0.25) << seconds << " s";
  }
}
INSTANTIATE_TEST_SUITE_P(Rates, LocalizerConsistency, ::testing::Values(1.0, 10.0));

TEST(LocalizerConsistencyOfTheDevice, QuantizationDoesNotMakeItOverconfident) {
  // Errors that persist instead of white noise: the default weights must not let the covariance
  // collapse.
  LocalizerConfig config;
  config.nominal_tension_n = 1.0;
  double nees = 0.0;
  for (std::uint32_t seed = 0; seed < kFlights; ++seed) {
    FlightOptions o = drawFlight(config, 10.0, seed);
    o.length_sigma = o.angle_sigma = 0.0;
    o.length_quantum = 0.00285;
    o.angle_quantum = 0.01;
    o.tension_sigma = 0.2;
    o.velocity_sigma = 0.05;
    FlightGenerator generator(o);
    Localizer localizer(config);
    localizer.reset(generator.truePosition(), generator.now());
    Estimate estimate;
    for (int i = 0; i < 1500; ++i) {
      generator.step();
      estimate = localizer.update(generator.now(), generator.frame(), generator.lastCommand(),
                                  generator.anchor());
    }
    const Eigen::Vector3d error = estimate.p_WD - generator.truePosition();
    nees += error.dot(estimate.P_position.ldlt().solve(error)) / kFlights;
  }
  EXPECT_LT(nees, 3.0 + spread(3));
  EXPECT_GT(nees, 0.5);
}

}  // namespace
}  // namespace tautline
