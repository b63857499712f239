#pragma once

/// @file
/// The Fotokite ground station at the level of its wire: takes the bytes a client sends, moves the
/// plant, and makes the bytes the device would send. It has its own parser and its own encoder and
/// shares only the protocol's constants (drivers/fotokite_protocol.h) with the driver under test.
/// Transport-agnostic: no file descriptor, no clock. Behaviour and its sources: docs/simulator.md.
///
/// Everything but the constructor: real-time safe: no allocation, no locks, no exceptions.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "common/time.h"
#include "drivers/fotokite_protocol.h"
#include "sim_hil/fotokite_emulator_config.h"
#include "sim_hil/line_buffer.h"
#include "sim_hil/plant.h"

namespace tautline::sim {

class FotokiteEmulator {
 public:
  /// `plant` must outlive the emulator.
  FotokiteEmulator(const FotokiteEmulatorConfig& config, Plant& plant) noexcept
      : config_(config), plant_(plant) {}

  /// Bytes from the client; complete lines are obeyed at once, in order.
  void receive(std::span<const std::uint8_t> bytes) noexcept;

  /// To be called after each step of the plant: time-outs, reel position moves, telemetry.
  void advance() noexcept;

  /// Takes bytes for the client; returns how many.
  [[nodiscard]] std::size_t transmit(std::span<std::uint8_t> out) noexcept {
    return output_.take(out);
  }

  [[nodiscard]] fotokite::GroundMode groundMode() const noexcept { return ground_mode_; }
  [[nodiscard]] fotokite::FlightMode flightMode() const noexcept;
  [[nodiscard]] std::uint16_t flags() const noexcept;
  [[nodiscard]] double telemetryRate() const noexcept;
  /// Lines that were no command, or not in this mode.
  [[nodiscard]] std::uint32_t refusedLines() const noexcept { return refused_lines_; }

 private:
  static constexpr std::size_t kMaxFields = 3;
  struct Fields {
    std::array<double, kMaxFields> value{};
    std::size_t count{0};
  };
  enum class ReelMode : std::uint8_t { kHold, kRate, kMove };

  void obey(std::string_view line) noexcept;
  [[nodiscard]] bool obeyMotion(std::string_view name, const Fields& f) noexcept;
  [[nodiscard]] bool obeySetup(std::string_view name, std::string_view rest,
                               const Fields& f) noexcept;
  void startTakeoff() noexcept;
  void stopMotors() noexcept;
  void stopRemoteControl() noexcept;
  void commit() noexcept;
  void setAngles(double elevation_rate, double azimuth_rate) noexcept;
  void moveReel(double counts) noexcept;
  void runReel(double counts_per_second) noexcept;
  void holdEverything() noexcept;
  void stepReel() noexcept;
  void stepTimeouts() noexcept;
  void stepTelemetry() noexcept;
  void sendStatusLines() noexcept;
  [[nodiscard]] bool flying() const noexcept;
  [[nodiscard]] bool batteryTooLow() const noexcept;

  FotokiteEmulatorConfig config_;
  Plant& plant_;
  InputLine input_;
  OutputLines output_;

  fotokite::GroundMode ground_mode_{fotokite::GroundMode::kMenu};
  VehicleRates rates_;
  ReelMode reel_mode_{ReelMode::kHold};
  double reel_rate_{0.0};    // [counts/s]
  double reel_target_{0.0};  // [counts]
  bool tether_controller_{true};

  struct Parameter {
    int id{0};
    double value{0.0};
  };
  std::array<Parameter, 8> pending_{};
  std::size_t pending_count_{0};
  double commanded_rate_{0.0};  // telemetry, 0 = default [Hz]

  struct Subscriptions {
    bool ground{false}, attitude{false}, position{false}, flight{false}, gimbal{false};
  } subscribed_;
  Time next_telemetry_{};
  Time next_status_{};

  Time last_command_{};
  Time motors_stopped_{};
  bool stopped_in_air_{false};
  bool has_flown_{false};
  bool low_launch_{false};
  bool was_on_{false};
  Time slack_since_{};
  std::uint32_t refused_lines_{0};
};

}  // namespace tautline::sim
