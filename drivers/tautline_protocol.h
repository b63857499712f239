#pragma once

/// @file
/// The Tautline bus as constants: what the station's codec and the simulator's own, independent
/// encoder have to agree on. No code. Bit layout of every message: config/tautline.dbc and
/// docs/devices.md.
///
/// CAN 2.0A, 500 kbit/s; the same messages over a serial line as COBS frames. Little endian, signed
/// numbers in two's complement. Every message carries an alive counter of 4 bits in the upper half
/// of its last byte but one, and a CRC-8 in its last byte. Axes and signs are Tautline's own
/// (docs/notation.md): elevation up positive, azimuth about +y from z towards x, attitude R_WB.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "common/fields.h"

namespace tautline::bus {

/// @name Identifiers
/// @{
inline constexpr std::uint16_t kReelId = 0x100;      ///< Reel controller to station.
inline constexpr std::uint16_t kAnglesId = 0x110;    ///< Tether angle sensor to station.
inline constexpr std::uint16_t kAttitudeId = 0x120;  ///< Vehicle to station.
inline constexpr std::uint16_t kVehicleId = 0x121;   ///< Vehicle to station.
inline constexpr std::uint16_t kRatesId = 0x200;     ///< Station to all, every cycle.
inline constexpr std::uint16_t kModeId = 0x210;      ///< Station to all, on change and repeated.
/// @}

inline constexpr std::size_t kMaxData = 8;   ///< Bytes in a message.
inline constexpr std::size_t kModeSize = 7;  ///< Bytes in a mode message; all others have kMaxData.

/// @name Timing
/// @{
inline constexpr auto kSensorPeriod = std::chrono::milliseconds(10);  ///< Of the four from sensors.
inline constexpr auto kModePeriod = std::chrono::milliseconds(100);  ///< An unchanged mode message.
inline constexpr int kTimeoutPeriods = 3;  ///< A message is missing after this many of its periods.
inline constexpr auto kCommandTimeout =
    std::chrono::milliseconds(200);  ///< Devices stop by themselves without kRatesId for this long.
/// @}

/// @name One unit on the wire
/// @{
inline constexpr double kCountUnit = 1e-4;    ///< Tether length [m].
inline constexpr double kSpeedUnit = 1e-3;    ///< Reel speed and length rate [m/s].
inline constexpr double kTensionUnit = 1e-3;  ///< [N]
inline constexpr double kAngleUnit = 1e-4;    ///< Elevation, azimuth [rad] and rates [rad/s].
inline constexpr double kQuaternionUnit = 0x1p-12;
inline constexpr double kBodyRateUnit = 0.05;  ///< [rad/s]
inline constexpr double kVoltageUnit = 0.05;   ///< [V]
inline constexpr double kGimbalUnit = 0.01;    ///< Gimbal pitch [rad].
/// @}

/// @name What a device accepts, symmetric about zero
/// @{
inline constexpr double kMaxLengthRate = 4.0;  ///< [m/s]
inline constexpr double kMaxAngleRate = 0.4;   ///< Elevation, azimuth, yaw [rad/s].
inline constexpr double kMaxGimbalRate = 3.0;  ///< [rad/s]
/// @}

/// First field of kModeId.
enum class BusMode : std::uint8_t {
  kDisarmed = 0,  ///< Nothing moves; rates are not obeyed.
  kArmed = 1,     ///< Rates are obeyed.
  kTakeoff = 2,   ///< Start the motors and lift off; as kArmed once in the air.
  kLand = 3,      ///< Come down by itself. Not sent by the station: it flies its landings itself.
  kStop = 4,      ///< Motors off at once.
};
inline constexpr std::array<EnumName<BusMode>, 5> kBusModeNames{{{BusMode::kDisarmed, "disarmed"},
                                                                 {BusMode::kArmed, "armed"},
                                                                 {BusMode::kTakeoff, "take-off"},
                                                                 {BusMode::kLand, "land"},
                                                                 {BusMode::kStop, "stop"}}};

/// First field of kVehicleId.
enum class FlightMode : std::uint8_t {
  kIdle = 1,
  kFlying = 2,
  kLanding = 3,
  kStopped = 4,
  kFault = 5,
};

/// Second field of kVehicleId, a bit set.
enum VehicleFlag : std::uint8_t {
  kLowBattery = 1U << 0U,
  kCriticalBattery = 1U << 1U,
  kNoCommands = 1U << 2U,  ///< No kRatesId for kCommandTimeout: standing still by itself.
  kSlackTether = 1U << 3U,
  kMotorFault = 1U << 4U,
};
inline constexpr std::array<EnumName<VehicleFlag>, 5> kVehicleFlagNames{
    {{kLowBattery, "LOW_BATTERY"},
     {kCriticalBattery, "CRITICAL_BATTERY"},
     {kNoCommands, "NO_COMMANDS"},
     {kSlackTether, "SLACK_TETHER"},
     {kMotorFault, "MOTOR_FAULT"}}};

/// Third field of kAnglesId.
enum class SensorStatus : std::uint8_t { kGood = 0, kStarting = 1, kFault = 2 };

/// @name Checks
/// @{
/// CRC-8 SAE J1850 over the identifier (low byte, high byte) and the data up to the CRC.
inline constexpr std::uint8_t kCrc8Polynomial = 0x1D;
inline constexpr std::uint8_t kCrc8Initial = 0xFF;
inline constexpr std::uint8_t kCrc8FinalXor = 0xFF;
inline constexpr unsigned kAliveModulus = 16;  ///< The alive counter goes 0 … 15 and starts again.
/// @}

/// @name Serial line
/// Before COBS: identifier (low byte, high byte), number of data bytes, data, CRC-16 (low byte,
/// high byte) over all of these. After COBS one zero byte ends the frame.
/// @{
inline constexpr int kDefaultBaud = 230400;  ///< 8N1; the sensors' messages fill a quarter of it.
inline constexpr std::size_t kSerialHeader = 3;
inline constexpr std::size_t kSerialCrc = 2;
inline constexpr std::uint16_t kCrc16Polynomial = 0x1021;  ///< CCITT-FALSE: not reflected, no xor.
inline constexpr std::uint16_t kCrc16Initial = 0xFFFF;
/// @}

}  // namespace tautline::bus
