#pragma once

/// @file
/// A ground station built from parts on the Tautline bus (reel controller, tether angle sensor,
/// vehicle), over CAN or over a serial line: units, calibration, end-to-end checks, pacing.

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include "common/fields.h"
#include "drivers/bus_frame.h"
#include "drivers/device.h"
#include "drivers/link_monitor.h"
#include "drivers/pace.h"
#include "drivers/tautline_codec.h"

namespace tautline {

struct TautlineConfig {
  double length_scale{1.0};
  double length_offset_m{0.0};
  double azimuth_offset_rad{0.0};
  double command_rate_hz{100.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_scale", length_scale, Range{0.1, 10},
            "true metres of tether per metre that the reel reports; calibrate");
    v.field("length_offset_m", length_offset_m, Range{-10, 100},
            "metres of tether out when the encoder reads zero");
    v.field("azimuth_offset_rad", azimuth_offset_rad, Range{-6.3, 6.3},
            "added to the sensor's azimuth and the vehicle's heading; zero when both start at +z");
    v.field("command_rate_hz", command_rate_hz, Range{10, 1000},
            "rate commands a second; at most one a cycle");
  }
};

/// All identifiers that a station listens to: those of sensors and vehicle, and its own, which only
/// another station can send.
inline constexpr std::array<std::uint16_t, 6> kTautlineIds{
    bus::kReelId, bus::kAnglesId, bus::kAttitudeId, bus::kVehicleId, bus::kRatesId, bus::kModeId};

/// Real-time safe but for the constructor: no allocation, no locks, no exceptions.
class TautlineDevice final : public Device {
 public:
  /// Its messages come a hundred times in it.
  static constexpr Duration kMonitorWindow = std::chrono::seconds(1);
  /// A sensor that sends more or less than its period by this factor is wrong.
  static constexpr double kRateTolerance = 1.6;

  /// `port` must outlive the device, `name` is a string literal. Pre-condition: `config` is within
  /// the ranges of TautlineConfig::fields().
  TautlineDevice(FramePort& port, const TautlineConfig& config, const char* name);

  /// A message that fails its end-to-end check leaves its sample as it is, getting older; one with
  /// an impossible value, or a sensor that reports a fault, makes it invalid until the next good
  /// one.
  void read(Time now, SensorFrame& frame) noexcept override;

  /// Not engaged: mode disarmed and zero rates, nothing else. A motor stop is the exception: it is
  /// sent whenever it is asked for, and again until the port has taken it.
  void write(Time now, const VehicleCommand& command) noexcept override;

  void shutdown(Time now) noexcept override;
  [[nodiscard]] LinkStatus status() const noexcept override;
  [[nodiscard]] const char* name() const noexcept override { return name_; }

  /// Sensor messages by end-to-end result since start.
  [[nodiscard]] std::uint32_t messages(bus::EndToEnd result) const noexcept {
    return results_[static_cast<std::size_t>(result)];
  }

 private:
  static constexpr std::size_t kSensorMessages = 4;

  /// One of the sensors' messages.
  struct Stream {
    bus::EndToEndCheck check;
    std::uint32_t used{0};
    std::uint32_t refused{0};  ///< By its end-to-end check.
    std::uint32_t used_before{0};
    std::uint32_t refused_before{0};    ///< Both at the start of the window.
    LinkFault fault{LinkFault::kNone};  ///< Of the last window.
  };

  void accept(Time now, const BusFrame& message, SensorFrame& frame) noexcept;
  void use(const BusFrame& message, const bus::Parsed& parsed, SensorFrame& frame) noexcept;
  void watch(Time now) noexcept;
  void judgeStreams(Time now) noexcept;
  [[nodiscard]] static LinkFault judge(const Stream& stream, double expected) noexcept;
  void restart() noexcept;
  [[nodiscard]] bool sendRates(const bus::Rates& rates) noexcept;
  void sendMode(Time now, const bus::ModeCommand& mode) noexcept;

  FramePort& port_;
  TautlineConfig config_;
  const char* name_;
  Eigen::Quaterniond R_WV_;  ///< World of the vehicle's attitude in ours: the azimuth offset.
  Duration rates_period_;

  std::array<Stream, kSensorMessages> streams_{};
  std::array<std::uint32_t, bus::kEndToEndCount> results_{};
  std::uint32_t timeouts_{0};
  std::uint32_t unknown_{0};
  bool was_connected_{false};
  std::uint32_t reconnects_seen_{0};
  LinkMonitor monitor_{kMonitorWindow};
  LinkFault fault_{LinkFault::kNone};
  Time window_start_{};
  LinkFault stream_fault_{LinkFault::kNone};
  std::optional<Time> other_station_;  ///< Last heard.

  Pace rates_pace_;
  Pace mode_pace_;
  bus::Rates sent_rates_;
  std::optional<bus::ModeCommand> sent_mode_;  ///< None: not since the link came up.
  bool owes_stop_{false};
  std::uint8_t rates_alive_{0};
  std::uint8_t mode_alive_{0};
};

}  // namespace tautline
