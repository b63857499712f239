#include "sim_hil/sensors.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "sim_hil/wind.h"

namespace tautline::sim {
namespace {

TEST(Random, IsNormal) {
  Random random(3);
  const int n = 200000;
  double sum = 0.0;
  double square = 0.0;
  double fourth = 0.0;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / n, 0.0, 0.01);
  EXPECT_NEAR(square / n, 1.0, 0.015);
  EXPECT_NEAR(fourth / n, 3.0, 0.1);
}

TEST(Random, SameSeedSameNumbers) {
  Random a(11);
  Random b(11);
  Random c(12);
  int equal = 0;
  for (int i = 0; i < 100; ++i) {
    const double x = a.normal();
    EXPECT_EQ(x, b.normal());
    equal += x == c.normal() ? 1 : 0;
  }
  EXPECT_EQ(equal, 0);
}

TEST(DelayLine, DeliversLateNeverEarly) {
  const SensorTiming timing{100.0, 0.035, 0.0};
  DelayLine<double> line(timing, -1.0);
  Random random(1);
  for (int ms = 0; ms <= 500; ++ms) {
    const Time now = Time{} + std::chrono::milliseconds(ms);
    if (line.due(now)) line.sample(now, ms, random);
    const double want = ms < 35 ? -1.0 : std::floor((ms - 35) / 10) * 10.0;
    EXPECT_EQ(line.read(now), want) << ms;
  }
}

SensorConfig perfect() {
  SensorConfig config;
  config.angle_noise = 0.0;
  config.attitude_noise = 0.0;
  config.barometer_noise = 0.0;
  return config;
}

TEST(Sensors, BiasesAreWhereTheyAreSet) {
  SensorConfig config = perfect();
  config.elevation_bias = 0.05;
  config.azimuth_bias = -0.1;
  config.barometer_bias = 2.0;
  const SensorInput truth{1234, {0.7, 3.1}, Eigen::Quaterniond::Identity(), 1.5};
  Sensors sensors(config, SensorInput{});
  Random random(1);
  for (int ms = 0; ms <= 200; ms += 2) {
    sensors.step(Time{} + std::chrono::milliseconds(ms), truth, random);
  }
  const SensorReadings got = sensors.read(Time{} + std::chrono::milliseconds(200));
  EXPECT_EQ(got.counts, 1234);
  EXPECT_NEAR(got.tangent.elevation, 0.75, 1e-12);
  EXPECT_NEAR(got.tangent.azimuth, 3.0, 1e-12);
  EXPECT_NEAR(got.altitude, 3.5, 1e-12);
}

TEST(Sensors, AngleNoiseIsIsotropicOnTheSphere) {
  SensorConfig config = perfect();
  config.angle_noise = 0.01;
  config.angles = {500.0, 0.0, 0.0};
  for (const double elevation : {0.0, 1.2}) {
    Sensors sensors(config, SensorInput{});
    Random random(5);
    const SensorInput truth{0, {elevation, 0.5}, Eigen::Quaterniond::Identity(), 0.0};
    double e2 = 0.0;
    double a2 = 0.0;
    const int n = 20000;
    for (int i = 1; i <= n; ++i) {
      const Time now = Time{} + std::chrono::milliseconds(2 * i);
      sensors.step(now, truth, random);
      const SensorReadings got = sensors.read(now);
      e2 += std::pow(got.tangent.elevation - elevation, 2);
      a2 += std::pow(std::cos(elevation) * (got.tangent.azimuth - 0.5), 2);
    }
    EXPECT_NEAR(std::sqrt(e2 / n), 0.01, 0.001);
    EXPECT_NEAR(std::sqrt(a2 / n), 0.01, 0.001);
  }
}

TEST(Wind, HasItsVarianceAndCorrelationTime) {
  WindConfig config;
  config.gust = 0.4;
  config.gust_time = 2.0;
  config.mean = {1.0, 0.0, 0.0};
  Wind wind(config);
  Random random(9);
  const int n = 200000;
  const int lag = 100;  // 2 s of 20 ms steps: one correlation time
  std::vector<double> x;
  for (int i = 0; i < n; ++i) {
    wind.step(0.02, 0.0, random);
    x.push_back(wind.velocity().x() - 1.0);
  }
  double square = 0.0;
  double product = 0.0;
  for (int i = 0; i + lag < n; ++i) {
    square += x[static_cast<std::size_t>(i)] * x[static_cast<std::size_t>(i)];
    product += x[static_cast<std::size_t>(i)] * x[static_cast<std::size_t>(i + lag)];
  }
  EXPECT_NEAR(std::sqrt(square / n), 0.4, 0.03);
  EXPECT_NEAR(product / square, std::exp(-1.0), 0.08);
}

}  // namespace
}  // namespace tautline::sim
