#pragma once

/// @file
/// The physical machine: vehicle, tether, reel, sensors and air in one scene, advanced by fixed
/// steps. No clock and no chance but the seed: the same commands at the same steps give the same
/// truth, bit for bit. World frame W.

#include <cstdint>

#include <Eigen/Core>

#include "common/mission/scene.h"
#include "common/time.h"
#include "sim_hil/fault_schedule.h"
#include "sim_hil/obstacles.h"
#include "sim_hil/random.h"
#include "sim_hil/reel.h"
#include "sim_hil/reel_faults.h"
#include "sim_hil/sensor_faults.h"
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

  /// @name What the emulated devices know, faults included
  /// @{
  /// For a telegram: what the sensors have delivered.
  [[nodiscard]] SensorReadings readSensors() noexcept {
    return sensor_faults_.apply(sensors_.read(truth_.time), reel_.metresPerCount(), faults_);
  }
  /// Voltage of the ground battery as measured [V].
  [[nodiscard]] double batteryVoltage() noexcept {
    return sensor_faults_.voltage(vehicle_.batteryVoltage(), faults_);
  }
  /// The devices' own clock.
  [[nodiscard]] Time clock() const noexcept { return clock_; }
  /// @}

  [[nodiscard]] FaultSchedule& faults() noexcept { return faults_; }
  [[nodiscard]] const FaultSchedule& faults() const noexcept { return faults_; }

  [[nodiscard]] Vehicle& vehicle() noexcept { return vehicle_; }
  [[nodiscard]] const Vehicle& vehicle() const noexcept { return vehicle_; }
  [[nodiscard]] Reel& reel() noexcept { return reel_; }
  [[nodiscard]] const Reel& reel() const noexcept { return reel_; }

 private:
  Plant(const SimConfig& config, Obstacles obstacles, const Eigen::Vector3d& start,
        std::uint64_t seed);

  void stepFaults() noexcept;
  void stepReel() noexcept;
  void stepClock() noexcept;
  void stepAir() noexcept;
  void checkCrash(const Eigen::Vector3d& v_before) noexcept;
  void crash(CrashReason reason) noexcept;
  void updateTruth() noexcept;
  void updateContacts() noexcept;
  [[nodiscard]] Eigen::Vector3d air() const noexcept;
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
  FaultSchedule faults_;
  SensorFaults sensor_faults_;
  ReelFaults reel_faults_;
  double behind_{
      0.0};  // tether that the drum has paid out and that is held back from the outlet [m]
  bool held_{false};
  bool cut_{false};
  Time clock_{};
  LooseContact clock_contact_;
  bool clock_jumped_{false};
  int air_countdown_{0};
};

}  // namespace tautline::sim
