#pragma once

/// @file
/// Fotokite wire format, bytes to structs and back: pure, no I/O, no clock, no calibration. Values
/// are the device's own (counts, elevation from the vertical); fotokite_device.h turns them into
/// Tautline's.
///
/// Everything here: real-time safe: no allocation, no locks, no exceptions.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>

#include "common/fields.h"

namespace tautline::fotokite {

struct GroundStatus {
  std::uint8_t mode{0};
  double run_time{0.0};         ///< Since the ground station's power-on [s].
  double battery_voltage{0.0};  ///< [V]
  double length_counts{
      0.0};  ///< Tether out since power-on [counts], negative when reeled in past the start.
};

/// Not necessarily of unit norm: the device rounds, so the codec accepts a norm of 1 +-
/// kQuaternionTolerance.
struct Quaternion {
  double w{1.0}, x{0.0}, y{0.0}, z{0.0};
};
struct Attitude {
  Quaternion q;  ///< Body to initialization frame.
};
struct Gimbal {
  Quaternion q;  ///< Gimbal to initialization frame.
};

struct Position {
  double elevation_from_vertical{0.0};  ///< [rad], 0 = straight up.
  double azimuth{0.0};                  ///< [rad], relative to the initialization.
  double altitude{0.0};                 ///< Barometric [m].
};

struct FlightStatus {
  std::uint8_t mode{0};
  double on_time{0.0};                 ///< [s]
  double backup_battery_voltage{0.0};  ///< [V]
  std::uint16_t flags{0};              ///< Bits of FlightFlag.
};

/// A line that is known and carries nothing for us (!Param).
struct Ignored {};

/// What the codec accepts; a field outside makes the whole line kOutOfRange.
inline constexpr Range kModeRange{0, 255};
inline constexpr Range kFlagsRange{0, 65535};
inline constexpr Range kRunTimeRange{0, 1e8};    ///< [s]
inline constexpr Range kVoltageRange{0, 100};    ///< [V]
inline constexpr Range kCountsRange{-1e6, 1e6};  ///< [counts], nearly 3 km of tether
inline constexpr Range kElevationRange{
    -0.05, 3.2};  ///< [rad], [0, pi] with the sensor's noise at its ends
inline constexpr Range kAzimuthRange{-6.3, 6.3};      ///< [rad], one turn either way
inline constexpr Range kAltitudeRange{-1000, 10000};  ///< [m]
inline constexpr double kQuaternionTolerance = 0.05;

enum class LineKind : std::uint8_t {
  kUnknown,
  kGroundStatus,
  kAttitude,
  kGimbal,
  kPosition,
  kFlightStatus,
  kParam
};

enum class LineError : std::uint8_t {
  kNone,
  kNotTelemetry,   ///< Does not start with '!': the rest of a cut line, or chatter of the device's
                   ///< shell.
  kUnknownHeader,  ///< Starts with '!' and is none of ours.
  kFieldCount,     ///< Too few or too many fields.
  kNotANumber,     ///< A field is not a plain number.
  kOutOfRange,     ///< A number no working device sends.
  kTooLong,  ///< No line end within LineAssembler::kMaxLine bytes. Reported by LineAssembler only.
};
inline constexpr std::size_t kLineErrorCount = 7;

struct ParsedLine {
  LineError error{LineError::kNone};
  LineKind kind{LineKind::kUnknown};  ///< What the header says, also when a field is wrong.
  std::variant<Ignored, GroundStatus, Attitude, Gimbal, Position, FlightStatus>
      value;  ///< Ignored unless kNone.
};

/// Parses one line, without its line end. Any bytes are allowed.
[[nodiscard]] ParsedLine parseTelemetry(std::string_view line) noexcept;

/// Cuts a byte stream into lines that end in "\n" or "\r\n". Empty lines are skipped. A line longer
/// than kMaxLine is discarded up to its end, so the next line is whole again. How the stream is
/// split into calls makes no difference.
class LineAssembler {
 public:
  static constexpr std::size_t kMaxLine = 160;  ///< The longest real line has about 60 bytes.

  /// Calls `on_line(std::string_view line, LineError error)` for each complete line: error is
  /// kNone, or kTooLong with an empty line. The view is valid during the call only.
  template <class OnLine>
  void push(std::span<const std::uint8_t> bytes, OnLine&& on_line) noexcept {
    for (const std::uint8_t byte : bytes) {
      if (byte != '\n') {
        append(static_cast<char>(byte));
        continue;
      }
      if (overlong_) {
        on_line(std::string_view{}, LineError::kTooLong);
      } else if (const std::string_view line = current(); !line.empty()) {
        on_line(line, LineError::kNone);
      }
      reset();
    }
  }

  /// Forgets an unfinished line, e.g. when the link was lost in its middle.
  void reset() noexcept {
    size_ = 0;
    overlong_ = false;
  }

 private:
  void append(char c) noexcept {
    if (size_ < buffer_.size()) {
      buffer_[size_++] = c;
    } else {
      overlong_ = true;
    }
  }

  [[nodiscard]] std::string_view current() const noexcept {
    const std::string_view line(buffer_.data(), size_);
    return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
  }

  std::array<char, kMaxLine> buffer_{};
  std::size_t size_{0};
  bool overlong_{false};
};

/// How many lines of each outcome; [kNone] counts the accepted ones.
struct LineCounters {
  std::array<std::uint32_t, kLineErrorCount> of{};

  void count(LineError error) noexcept { ++of[static_cast<std::size_t>(error)]; }
  [[nodiscard]] std::uint32_t operator[](LineError error) const noexcept {
    return of[static_cast<std::size_t>(error)];
  }
  [[nodiscard]] std::uint32_t good() const noexcept { return (*this)[LineError::kNone]; }
  [[nodiscard]] std::uint32_t bad() const noexcept;
};

/// One command line with its "\n".
class Command {
 public:
  static constexpr std::size_t kMaxSize = 64;

  [[nodiscard]] std::string_view text() const noexcept { return {buffer_.data(), size_}; }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept;

  /// Building blocks of the format functions below. What does not fit is left out.
  Command& append(std::string_view text) noexcept;
  Command& append(char c) noexcept { return append(std::string_view(&c, 1)); }
  /// Fixed point, rounded half away from zero, |value| <= 1e9 (clamped), 0 <= decimals <= 6; NaN
  /// gives 0.
  Command& append(double value, int decimals) noexcept;

 private:
  std::array<char, kMaxSize> buffer_{};
  std::size_t size_{0};
};

/// Rates beyond the device's limits (fotokite_protocol.h) are clamped; a rate that is not finite
/// becomes 0.
[[nodiscard]] Command formatPos(double elevation_rate, double azimuth_rate,
                                double length_change_counts) noexcept;
[[nodiscard]] Command formatPos2(double elevation_rate, double azimuth_rate,
                                 double reel_counts_per_s) noexcept;
[[nodiscard]] Command formatYaw(double yaw_rate) noexcept;
[[nodiscard]] Command formatGimbal(double pitch_rate, double roll_rate) noexcept;
[[nodiscard]] Command formatSetParameter(int id, double value) noexcept;  ///< "Pset 117,10.0"
[[nodiscard]] Command formatSetParameter(int id, int value) noexcept;     ///< "Pset 119,0"

/// A command without fields, or any fixed line: `text` + "\n".
[[nodiscard]] Command formatLine(std::string_view text) noexcept;

}  // namespace tautline::fotokite
