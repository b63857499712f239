#include "sim_hil/sensors.h"

namespace tautline::sim {

Sensors::Sensors(const SensorConfig& config, const SensorInput& initial) noexcept
    : config_(config),
      encoder_(config.encoder, initial.counts),
      angles_(config.angles, initial.tangent),
      attitude_(config.attitude, initial.attitude),
      barometer_(config.barometer, initial.altitude) {}

void Sensors::step(Time now, const SensorInput& truth, Random& random) noexcept {
  if (encoder_.due(now)) encoder_.sample(now, truth.counts, random);
  if (angles_.due(now)) {
    // Noise on the direction, not on the angles: near the pole the azimuth means little.
    const Eigen::Vector3d noisy =
        unitVector(truth.tangent) + config_.angle_noise * random.normal3();
    const Polar sensed = polarOf(noisy);
    angles_.sample(
        now,
        {sensed.elevation + config_.elevation_bias, wrapped(sensed.azimuth + config_.azimuth_bias)},
        random);
  }
  if (attitude_.due(now)) {
    const Eigen::Vector3d e = 0.5 * config_.attitude_noise * random.normal3();
    const Eigen::Quaterniond error = Eigen::Quaterniond(1.0, e.x(), e.y(), e.z()).normalized();
    attitude_.sample(now, truth.attitude * error, random);
  }
  if (barometer_.due(now)) {
    barometer_.sample(
        now, truth.altitude + config_.barometer_bias + config_.barometer_noise * random.normal(),
        random);
  }
}

SensorReadings Sensors::read(Time now) noexcept {
  SensorReadings readings;
  readings.counts = encoder_.read(now);
  readings.tangent = angles_.read(now);
  readings.attitude = attitude_.read(now);
  readings.altitude = barometer_.read(now);
  return readings;
}

}  // namespace tautline::sim
