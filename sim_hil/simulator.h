#pragma once

/// @file
/// The simulated machine behind its wire protocol: plant + emulated devices on one virtual clock.
/// Used in lock-step by the bench and in real time by tautline-sim.
///
///     Simulator sim(config, sceneInWorld(scene), seed);
///     sim.receive(bytes_from_station);
///     sim.advanceTo(Time{} + 10ms);
///     const std::size_t n = sim.transmit(buffer);
///
/// The same config, scene, seed and input bytes at the same virtual times give the same output
/// bytes and the same truth, bit for bit.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "common/mission/scene.h"
#include "common/time.h"
#include "sim_hil/fault.h"
#include "sim_hil/sim_config.h"
#include "sim_hil/truth.h"

namespace tautline::sim {

class Simulator {
 public:
  /// `world` is in W (sceneInWorld()); the drone stands at its start, by default 1 m in front (+z)
  /// of the reel on the floor. The machine is dispersed(config, seed). The virtual clock starts at
  /// Time{}. Throws InputError if the scene has more or larger obstacles than the plant takes. Not
  /// real-time safe: start-up only.
  Simulator(const SimConfig& config, const Scene& world, std::uint64_t seed);
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  /// Steps the machine up to `t` in whole steps of config.step: it then stands at the last step
  /// that is not after `t`. Times before now() do nothing. Real-time safe: no allocation, no locks,
  /// no exceptions.
  void advanceTo(Time t) noexcept;

  /// Bytes from the station, effective now. Real-time safe: no allocation, no locks, no exceptions.
  void receive(std::span<const std::uint8_t> bytes) noexcept;

  /// Takes telemetry bytes that are due; returns how many were written to `out`. Lines that nobody
  /// takes are dropped whole once the device's buffer is full. Real-time safe: no allocation, no
  /// locks, no exceptions.
  [[nodiscard]] std::size_t transmit(std::span<std::uint8_t> out) noexcept;

  /// Schedules a fault that has passed checkFault(); a time that is past means now. False if too
  /// many are scheduled already. Real-time safe: no allocation, no locks, no exceptions.
  [[nodiscard]] bool inject(const Fault& fault) noexcept;

  /// The cable to the station is out: whoever connects the two lets nothing pass. Real-time safe:
  /// no allocation, no locks, no exceptions.
  [[nodiscard]] bool unplugged() const noexcept;

  [[nodiscard]] const Truth& truth() const noexcept;
  [[nodiscard]] Time now() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tautline::sim
