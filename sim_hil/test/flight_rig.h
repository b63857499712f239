#pragma once

/// @file
/// Flies a Plant by its vehicle and reel directly, without the wire: for tests and benchmarks.

#include <cmath>

#include "sim_hil/plant.h"

namespace tautline::sim {

inline Scene emptyRoom(double start_distance = 0.9) {
  Scene scene;
  scene.name = "empty";
  scene.min = {-20.0, -0.3, -20.0};
  scene.max = {20.0, 20.0, 20.0};
  scene.floor = -0.3;
  scene.start = Eigen::Vector3d(0.0, -0.2, start_distance);
  return scene;
}

inline SimConfig calmConfig() {
  SimConfig config;
  config.wind.gust = 0.0;
  return config;
}

class FlightRig {
 public:
  explicit FlightRig(const SimConfig& config = calmConfig(), const Scene& scene = emptyRoom(),
                     std::uint64_t seed = 1)
      : plant_(config, scene, seed) {}

  [[nodiscard]] Plant& plant() { return plant_; }
  [[nodiscard]] const Truth& truth() const { return plant_.truth(); }

  template <class EachStep>
  void run(double seconds, EachStep&& each_step) {
    const int steps = static_cast<int>(std::lround(seconds / toSeconds(plant_.stepDuration())));
    for (int i = 0; i < steps; ++i) {
      plant_.step();
      each_step();
    }
  }
  void run(double seconds) {
    run(seconds, [] {});
  }

  void takeOff() {
    plant_.reel().lock(true);
    plant_.vehicle().startTakeoff();
    run(8.0);
  }

  void rates(double elevation, double azimuth) {
    VehicleRates r;
    r.elevation = elevation;
    r.azimuth = azimuth;
    plant_.vehicle().command(r);
  }

  /// Length, elevation and azimuth of the set-point, one after the other, then rest.
  void goTo(double length, double elevation, double azimuth) {
    const double scale = plant_.reel().metresPerCount();
    plant_.reel().lock(false);
    for (int i = 0; i < 60000 && std::abs(truth().length - length) > 0.005; ++i) {
      const double speed = std::clamp(2.0 * (length - truth().length), -0.3, 0.3);
      plant_.reel().command(speed / scale);
      plant_.step();
    }
    plant_.reel().lock(true);
    turn(elevation - truth().setpoint_elevation, 0.2, true);
    turn(wrapped(azimuth - truth().setpoint_azimuth), 0.2, false);
    run(4.0);
  }

 private:
  void turn(double angle, double rate, bool elevation) {
    const double signed_rate = std::copysign(rate, angle);
    rates(elevation ? signed_rate : 0.0, elevation ? 0.0 : signed_rate);
    run(std::abs(angle) / rate);
    rates(0.0, 0.0);
  }

  Plant plant_;
};

}  // namespace tautline::sim
