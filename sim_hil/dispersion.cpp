#include "sim_hil/dispersion.h"

#include <cmath>

#include "sim_hil/random.h"
#include "sim_hil/sim_config.h"

namespace tautline::sim {
namespace {

constexpr std::uint64_t kStream = 0x64697370'65727365U;  // apart from air, sensors and faults
constexpr double kCutOff = 2.0;                          // standard deviations

double drawn(Random& random) noexcept {
  double x = random.normal();
  while (std::abs(x) > kCutOff) x = random.normal();
  return x;
}

}  // namespace

SimConfig dispersed(const SimConfig& config, std::uint64_t seed) noexcept {
  Random random(seed ^ kStream);
  const DispersionConfig& sigma = config.dispersion;
  SimConfig flight = config;
  flight.vehicle.tension = std::fmax(0.0, config.vehicle.tension + sigma.tension * drawn(random));
  flight.sensors.elevation_bias += sigma.elevation_bias * drawn(random);
  flight.sensors.azimuth_bias += sigma.azimuth_bias * drawn(random);
  flight.reel.scale += sigma.reel_scale * drawn(random);
  flight.dispersion = {};
  return flight;
}

}  // namespace tautline::sim
