#pragma once

/// @file
/// The Fotokite Pro as a Device: units, calibration, sign conventions, start sequence and command
/// pacing on top of fotokite_codec.h. Protocol facts, signs and calibration: docs/devices.md.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include "common/fields.h"
#include "common/vehicle.h"
#include "drivers/byte_port.h"
#include "drivers/device.h"
#include "drivers/fotokite_codec.h"
#include "drivers/fotokite_protocol.h"
#include "drivers/link_monitor.h"
#include "drivers/pace.h"

namespace tautline {

/// Which way z of the device's initialization frame points. x is forward at initialization, the
/// frame is right-handed.
enum class VerticalAxis : std::uint8_t { kDown, kUp };
inline constexpr std::array<EnumName<VerticalAxis>, 2> kVerticalAxisNames{
    {{VerticalAxis::kDown, "down"}, {VerticalAxis::kUp, "up"}}};

struct FotokiteConfig {
  double length_scale_m_per_count{fotokite::kMetresPerCount};
  double length_offset_m{0.0};       ///< Tether out when the encoder reads 0.
  bool invert_length{false};         ///< Counts grow when tether is reeled in.
  double azimuth_offset_rad{0.0};    ///< World azimuth minus the device's.
  double elevation_offset_rad{0.0};  ///< Above what the device's angle from the vertical says.
  VerticalAxis attitude_z{VerticalAxis::kDown};
  double telemetry_rate_hz{fotokite::kDefaultTelemetryRate};
  double command_rate_hz{20.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_scale_m_per_count", length_scale_m_per_count, Range{1e-4, 0.1},
            "metres of tether per encoder count; calibrate");
    v.field("length_offset_m", length_offset_m, Range{-10, 100},
            "metres of tether out when the encoder reads zero");
    v.field("invert_length", invert_length, "encoder counts grow when tether is reeled in");
    v.field("azimuth_offset_rad", azimuth_offset_rad, Range{-6.3, 6.3},
            "added to the device's azimuth; zero when it is initialized facing +x");
    v.field("elevation_offset_rad", elevation_offset_rad, Range{-0.2, 0.2},
            "added to the device's elevation; calibrate with a tether of known elevation");
    v.choice("attitude_z", attitude_z, kVerticalAxisNames,
             "z axis of the attitude and gimbal quaternions");
    v.field("telemetry_rate_hz", telemetry_rate_hz, Range{1, 100},
            "attitude and position lines a second (parameter 117)");
    v.field("command_rate_hz", command_rate_hz, Range{5, 1000},
            "rate commands a second; at most one a cycle");
  }
};

/// Real-time safe but for the constructor: no allocation, no locks, no exceptions.
class FotokiteDevice final : public Device {
 public:
  static constexpr Duration kStartLineInterval = std::chrono::milliseconds(10);
  /// In another ground mode, or silent, for this long: the start sequence is sent again.
  static constexpr Duration kRemoteControlTimeout = std::chrono::seconds(2);
  static constexpr Duration kSilenceTimeout = std::chrono::seconds(5);
  /// Telemetry comes once a second at least.
  static constexpr Duration kMonitorWindow = std::chrono::seconds(3);
  /// An unchanged gimbal rate is repeated.
  static constexpr Duration kGimbalPeriod = std::chrono::milliseconds(500);

  /// `port` must outlive the device. Pre-condition: `config` is within the ranges of
  /// FotokiteConfig::fields().
  FotokiteDevice(BytePort& port, const FotokiteConfig& config);

  void read(Time now, SensorFrame& frame) noexcept override;

  /// Not engaged: stand still and hold the tether, nothing else. MotorStop is the exception: it is
  /// sent whenever it is asked for, also during the start sequence. Rates that are not finite
  /// become zero, those beyond the device's limits are clamped.
  void write(Time now, const VehicleCommand& command) noexcept override;

  void shutdown(Time now) noexcept override;
  [[nodiscard]] LinkStatus status() const noexcept override;
  [[nodiscard]] const char* name() const noexcept override { return "fotokite"; }

  /// Lines by outcome since start.
  [[nodiscard]] const fotokite::LineCounters& lines() const noexcept { return lines_; }

  /// The start sequence is through and rate commands are being sent.
  [[nodiscard]] bool started() const noexcept { return start_step_ == kStartLines; }

 private:
  static constexpr std::size_t kParameterLines = 4;
  static constexpr std::size_t kStartLines =
      fotokite::kStartRemoteControl.size() + kParameterLines + fotokite::kSubscribe.size();

  /// Motion in the device's own units and signs. As constructed: stand still, hold the tether.
  struct Rates {
    bool hold{true};  ///< Hold the tether's length instead of running the reel at a rate.
    double elevation{0.0}, azimuth{0.0}, reel{0.0}, yaw{0.0}, gimbal{0.0};

    [[nodiscard]] bool operator==(const Rates&) const noexcept = default;
    [[nodiscard]] bool zero() const noexcept;
  };

  void restart() noexcept;
  void accept(Time now, const fotokite::ParsedLine& line, SensorFrame& frame) noexcept;
  void acceptGround(Time now, const fotokite::GroundStatus& ground, SensorFrame& frame) noexcept;
  [[nodiscard]] bool lostRemoteControl(Time now) const noexcept;
  [[nodiscard]] fotokite::Command startLine(std::size_t step) const noexcept;
  void sendStartLine(Time now) noexcept;
  void sendAction(Time now, VehicleAction action) noexcept;
  void sendTetherController(bool on) noexcept;
  void sendRates(Time now, const Rates& rates) noexcept;
  void send(const fotokite::Command& command) noexcept;
  [[nodiscard]] Rates toDevice(const VehicleCommand& command) const noexcept;

  BytePort& port_;
  FotokiteConfig config_;
  Eigen::Quaterniond R_WI_;  ///< Initialization frame I in the world.
  Eigen::Quaterniond R_VB_;  ///< Body axes B in the vehicle's own V, whose z points as that of I.
  double z_sign_;            ///< +1 where z of I and V points up, -1 where down.
  double counts_per_metre_;  ///< Signed: pay-out positive [counts/m].
  Duration command_period_;

  fotokite::LineAssembler assembler_;
  std::uint64_t text_bytes_{0};
  LinkMonitor monitor_{kMonitorWindow};
  LinkFault fault_{LinkFault::kNone};
  fotokite::LineCounters lines_;

  bool was_connected_{false};
  std::uint32_t reconnects_seen_{0};
  std::size_t start_step_{0};
  Pace start_pace_;
  std::optional<Time> last_telemetry_;    ///< Last accepted line, or the end of the start sequence.
  std::optional<Time> not_remote_since_;  ///< In another ground mode since then.

  Rates sent_;
  Pace rates_pace_;
  Pace gimbal_pace_;
  VehicleAction sent_action_{VehicleAction::kNone};
  Pace action_pace_;
  std::optional<bool> tether_controller_;  ///< Last told to the device since its start.
};

}  // namespace tautline
