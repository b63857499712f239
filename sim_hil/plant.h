#pragma once

/// @file
/// The physical machine: vehicle, tether, reel, sensors and air in one scene, advanced by fixed
/// steps. No clock and no chance but the seed: the same commands at the same steps give the same
/// truth, bit for bit. World frame W.

#include <cstdint>

#include <Eigen/Core>

#include "common/mission/scene.h"
#include "common/time.h"
#include "sim_hil/obstacles.h"
#include "sim_hil/random.h"
#include "sim_hil/reel.h"
#include "sim_hil/sensors.h"
#include "sim_hil/sim_config.h"
#include "sim_hil/tether_chain.h"
#include "sim_hil/truth.h"
#include "sim_hil/vehicle.h"
#include "sim_hil/wind.h"

namespace tautline::sim {

class Plant {
 public:
  /// `world` is in W. Throws InputError if the scene is more than the plant takes, or if an
  /// obstacle stands between the reel and the start. Not real-time safe: start-up only.
  Plant(const SimConfig& config, const Scene& world, std::uint64_t seed);

  /// One step of the virtual clock. Real-time safe: no allocation, no locks, no exceptions.
  void step() noexcept;

  [[nodiscard]] Time now() const noexcept { return truth_.time; }
  [[nodiscard]] Duration stepDuration() const noexcept { return step_; }
  [[nodiscard]] const Truth& truth() const noexcept { return truth_; }
  [[nodiscard]] const TetherChain& tether() const noexcept { return tether_; }
  [[nodiscard]] SensorReadings readSensors() noexcept { return sensors_.read(truth_.time); }

  [[nodiscard]] Vehicle& vehicle() noexcept { return vehicle_; }
  [[nodiscard]] const Vehicle& vehicle() const noexcept { return vehicle_; }
  [[nodiscard]] Reel& reel() noexcept { return reel_; }
  [[nodiscard]] const Reel& reel() const noexcept { return reel_; }

 private:
  Plant(const SimConfig& config, Obstacles obstacles, const Eigen::Vector3d& start,
        std::uint64_t seed);

  void stepAir() noexcept;
  void checkCrash(const Eigen::Vector3d& v_before) noexcept;
  void crash(CrashReason reason) noexcept;
  void updateTruth() noexcept;
  void updateContacts() noexcept;
  [[nodiscard]] SensorInput sensorInput() const noexcept;

  SimConfig config_;
  Duration step_;
  double h_;
  Obstacles obstacles_;
  Random random_;
  Eigen::Vector3d p_start_;
  double foot_;    // height of the attachment over what the vehicle stands on
  double ground_;  // under the vehicle
  TetherChain tether_;
  Reel reel_;
  Vehicle vehicle_;
  Wind wind_;
  Truth truth_;
  Sensors sensors_;
  int air_countdown_{0};
};

}  // namespace tautline::sim
