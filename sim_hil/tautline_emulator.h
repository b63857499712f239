#pragma once

/// @file
/// Reel controller, tether angle sensor and vehicle on the Tautline bus, at the level of their
/// messages: takes what the station sends, moves the plant, and makes what the devices would send.
/// It has its own parser and its own encoder and shares only the protocol's constants
/// (drivers/tautline_protocol.h) with the driver under test. Wires: tautline_wire.h.
///
/// Everything but the constructor: real-time safe: no allocation, no locks, no exceptions.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/time.h"
#include "drivers/tautline_protocol.h"
#include "sim_hil/plant.h"
#include "sim_hil/tautline_emulator_config.h"
#include "sim_hil/tautline_frame.h"

namespace tautline::sim {

class TautlineEmulator {
 public:
  /// `plant` must outlive the emulator.
  TautlineEmulator(const TautlineEmulatorConfig& config, Plant& plant) noexcept
      : config_(config), plant_(plant) {}

  /// A message from the bus; obeyed at once if it is right.
  void receive(const TautlineFrame& frame) noexcept;

  /// To be called after each step of the plant: time-outs and sensors.
  void advance() noexcept;

  /// Takes the oldest message that is to be sent; false if there is none. What nobody takes is
  /// dropped, the oldest first.
  [[nodiscard]] bool transmit(TautlineFrame& out) noexcept;

  [[nodiscard]] bus::FlightMode flightMode() const noexcept;
  [[nodiscard]] std::uint8_t flags() const noexcept;
  /// Messages that were not for a device here, or failed a check.
  [[nodiscard]] std::uint32_t refused() const noexcept { return refused_; }

 private:
  static constexpr std::size_t kQueue = 256;

  [[nodiscard]] bool obeyRates(std::uint64_t bits) noexcept;
  [[nodiscard]] bool obeyMode(std::uint64_t bits) noexcept;
  void obeyRatesNow() noexcept;
  void startTakeoff() noexcept;
  void stopMotors() noexcept;
  void rest() noexcept;
  void sendSensors() noexcept;
  void send(std::uint16_t id, std::uint64_t bits) noexcept;
  [[nodiscard]] bool flying() const noexcept;
  [[nodiscard]] bool batteryTooLow() const noexcept;
  [[nodiscard]] bool commandsMissing() const noexcept;

  TautlineEmulatorConfig config_;
  Plant& plant_;

  bus::BusMode mode_{bus::BusMode::kDisarmed};
  bool reel_controller_{false};
  VehicleRates rates_;
  double length_rate_{0.0};  // [m/s]
  std::optional<Time> last_rates_;
  std::optional<unsigned> rates_alive_;
  std::optional<unsigned> mode_alive_;

  Time next_sensors_{};
  std::array<unsigned, 4> alive_{};
  std::array<TautlineFrame, kQueue> queue_{};
  std::size_t head_{0};
  std::size_t tail_{0};

  bool was_on_{false};
  bool stopped_in_air_{false};
  bool has_flown_{false};
  Time motors_stopped_{};
  std::uint32_t refused_{0};
};

}  // namespace tautline::sim
