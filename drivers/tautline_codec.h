#pragma once

/// @file
/// The messages of the Tautline bus, bytes to structs and back, and their end-to-end check: pure,
/// no I/O, no clock. The layout of each message is one table in tautline_codec.cpp.
///
/// Everything here: real-time safe: no allocation, no locks, no exceptions.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

#include "common/fields.h"
#include "common/time.h"
#include "drivers/bus_frame.h"
#include "drivers/tautline_protocol.h"

namespace tautline::bus {

/// @name Messages, in SI units
/// @{
struct Reel {
  std::int32_t counts{0};  ///< Encoder, kCountUnit each, pay-out positive.
  double speed{0.0};       ///< [m/s], pay-out positive.
  double tension{0.0};     ///< At the motor [N].
};
struct Angles {
  double elevation{0.0};  ///< [rad], up positive.
  double azimuth{0.0};    ///< [rad], about +y from z towards x.
  SensorStatus status{SensorStatus::kGood};
};
/// R_WB, not necessarily of unit norm: accepted within kQuaternionTolerance.
struct Attitude {
  double w{1.0}, x{0.0}, y{0.0}, z{0.0};
};
struct VehicleStatus {
  FlightMode mode{FlightMode::kIdle};
  std::uint8_t flags{0};          ///< Bits of VehicleFlag.
  double battery_voltage{0.0};    ///< [V]
  double gimbal_pitch{0.0};       ///< [rad], up positive.
  double p{0.0}, q{0.0}, r{0.0};  ///< Body rates about x, y, z [rad/s].
};
/// Rates beyond the device's limits are clamped, what is not finite becomes 0.
struct Rates {
  double length{0.0};     ///< [m/s], pay-out positive.
  double elevation{0.0};  ///< [rad/s]
  double azimuth{0.0};    ///< [rad/s]
  double yaw{0.0};        ///< About +y [rad/s].
};
struct ModeCommand {
  BusMode mode{BusMode::kDisarmed};
  bool reel_controller{false};  ///< The reel follows length rates; otherwise it holds.
  double gimbal_pitch{0.0};     ///< [rad/s], up positive; clamped, not finite becomes 0.
  double gimbal_roll{0.0};      ///< [rad/s]
};
/// @}

/// Accepted beyond what the bits allow; a value outside makes the whole message kOutOfRange.
inline constexpr double kQuaternionTolerance = 0.05;
inline constexpr Range kElevationRange{-1.6208, 1.6208};  ///< [rad], a right angle and noise.

enum class MessageError : std::uint8_t {
  kNone,
  kUnknownId,   ///< None of ours.
  kSize,        ///< One of ours with another number of bytes.
  kCrc,         ///< Garbled, or someone else's.
  kOutOfRange,  ///< A value that no working device sends.
};
inline constexpr std::size_t kMessageErrorCount = 5;

struct Parsed {
  MessageError error{MessageError::kNone};
  std::uint8_t alive{0};  ///< Set if the CRC is right.
  std::variant<std::monostate, Reel, Angles, Attitude, VehicleStatus, Rates, ModeCommand>
      value;  ///< Nothing unless error is kNone.
};

/// Any frame is allowed, its time is not looked at.
[[nodiscard]] Parsed parse(const BusFrame& frame) noexcept;

/// @name Frames to send. Values are rounded to the wire's units and clamped to what its bits hold.
/// @{
[[nodiscard]] BusFrame encode(const Reel& value, std::uint8_t alive) noexcept;
[[nodiscard]] BusFrame encode(const Angles& value, std::uint8_t alive) noexcept;
[[nodiscard]] BusFrame encode(const Attitude& value, std::uint8_t alive) noexcept;
[[nodiscard]] BusFrame encode(const VehicleStatus& value, std::uint8_t alive) noexcept;
[[nodiscard]] BusFrame encode(const Rates& value, std::uint8_t alive) noexcept;
[[nodiscard]] BusFrame encode(const ModeCommand& value, std::uint8_t alive) noexcept;
/// @}

/// CRC-8 SAE J1850 over identifier and `data`.
[[nodiscard]] std::uint8_t crc8(std::uint16_t id, std::span<const std::uint8_t> data) noexcept;

/// One field of a message, for documentation and its test.
struct Signal {
  const char* name;
  std::uint8_t start;  ///< Lowest bit, counted from bit 0 of byte 0.
  std::uint8_t width;  ///< [bit]
  bool is_signed;
  double unit;  ///< Physical value of 1.
};
struct MessageLayout {
  std::uint16_t id;
  const char* name;
  std::uint8_t size;
  std::span<const Signal> signals;  ///< Without alive counter and CRC.
};
/// All messages, in the order of their identifiers.
[[nodiscard]] std::span<const MessageLayout> layouts() noexcept;

/// End-to-end result of one received message.
enum class EndToEnd : std::uint8_t {
  kOk,
  kRepeated,       ///< The same alive counter again: a doubled frame or a stuck sender.
  kWrongSequence,  ///< Frames are missing or out of order. Not to be used; the next one counts
                   ///< again.
  kError,          ///< Wrong CRC, size or value.
};
inline constexpr std::size_t kEndToEndCount = 4;

/// Watches one message.
class EndToEndCheck {
 public:
  /// For each frame of this message. The first one is kOk whatever its counter; the first after a
  /// time-out, if its counter has moved at all: a stuck sender never gets through.
  [[nodiscard]] EndToEnd check(Time now, const Parsed& message) noexcept;

  /// Once a cycle: true in the cycle in which nothing usable has come for `timeout`. False before
  /// the first message.
  [[nodiscard]] bool timedOut(Time now, Duration timeout) noexcept;

  /// Forgets the counter: the sender may have started anew.
  void reset() noexcept {
    last_alive_.reset();
    last_ok_.reset();
  }

 private:
  std::optional<std::uint8_t> last_alive_;
  std::optional<Time> last_ok_;  ///< None: nothing usable yet, or not since the last time-out.
};

}  // namespace tautline::bus
