#pragma once

/// @file
/// The seam between the station's core and its devices: what sensors say (SensorFrame) and what the
/// station commands (VehicleCommand). Plain data: drivers fill and read it, estimation and control
/// see nothing else of the hardware.
///
/// Frames and symbols: docs/notation.md. SI units, radians. Every sample carries time, sequence and
/// validity; "no new data" is a normal state: the sample keeps its old sequence number.

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/fields.h"
#include "common/time.h"

namespace tautline {

/// What a run is made of. In every state message and in every log's name.
enum class RunMode : std::uint8_t { kSim, kHil, kReal };
inline constexpr std::array<EnumName<RunMode>, 3> kRunModeNames{
    {{RunMode::kSim, "SIM"}, {RunMode::kHil, "HIL"}, {RunMode::kReal, "REAL"}}};

template <class T>
struct Sample {
  Time time{};  ///< When it was measured, or (no time stamp in the protocol) when its last byte
                ///< arrived.
  std::uint32_t sequence{0};  ///< Grows by one with each new sample; 0 = none yet.
  bool valid{false};          ///< False: never received, or the last one was out of range.
  T value{};
};

/// Makes `value` the newest sample. Real-time safe: no allocation, no locks, no exceptions.
template <class T>
void update(Sample<T>& sample, Time time, const T& value) noexcept {
  sample.time = time;
  ++sample.sequence;
  sample.valid = true;
  sample.value = value;
}

/// Tether reel. `length` is total tether out, reel to drone, by the driver's nominal calibration.
struct ReelReading {
  double counts{0.0};  ///< Raw encoder counts since the reel's power-on.
  double length{0.0};  ///< L_total_meas [m], >= 0, nominal scale and offset applied.
  std::optional<double>
      tension;  ///< Motor tension at the reel [N], where the reel has that sensor.
};

/// Tether angles sensed at the drone: the tangent of the tether at D, so relative to the active
/// anchor A, with sag.
struct TetherAngles {
  double theta{0.0};               ///< Tangent elevation at D [rad], in [-pi/2, pi/2], up positive.
  double phi{0.0};                 ///< Azimuth [rad], about +y from z towards x, any branch.
  std::optional<double> altitude;  ///< Barometric height above take-off [m], where sensed.
};

struct AttitudeReading {
  Eigen::Quaterniond R_WB{Eigen::Quaterniond::Identity()};  ///< Body B to world W; level = identity
                                                            ///< up to yaw. Unit norm.
};

struct GimbalReading {
  double pitch{0.0};  ///< Camera pitch [rad], up positive, 0 = horizon.
};

/// What the vehicle says it is doing, in terms that every device can map to.
enum class VehiclePhase : std::uint8_t { kUnknown, kIdle, kFlying, kLanding, kStopped, kFault };
inline constexpr std::array<EnumName<VehiclePhase>, 6> kVehiclePhaseNames{
    {{VehiclePhase::kUnknown, "unknown"},
     {VehiclePhase::kIdle, "idle"},
     {VehiclePhase::kFlying, "flying"},
     {VehiclePhase::kLanding, "landing"},
     {VehiclePhase::kStopped, "stopped"},
     {VehiclePhase::kFault, "fault"}}};

/// Whose codes a vehicle's flight mode and flags are.
enum class VehicleProtocol : std::uint8_t { kUnknown, kFotokite, kTautline };

struct VehicleReading {
  VehiclePhase phase{VehiclePhase::kUnknown};
  std::uint8_t flight_mode{0};       ///< Device's own code (docs/devices.md).
  std::uint16_t flags{0};            ///< Device's own flag bits, 0 = all good.
  double backup_battery_voltage{0};  ///< [V], 0 = not sensed.
  VehicleProtocol protocol{VehicleProtocol::kUnknown};
};

struct GroundReading {
  std::uint8_t mode{0};       ///< Device's own code; 10 = remote controlled.
  double battery_voltage{0};  ///< [V]
};

/// What is wrong with a link, or why there is none, as far as the driver can tell. Each has its
/// text and its remedy in app/station/events.h.
enum class LinkFault : std::uint8_t {
  kNone,
  kSilent,            ///< Connected, and nothing is heard.
  kGarbage,           ///< Bytes arrive that mean nothing: wrong baud rate, damaged line.
  kOtherProtocol,     ///< A device that speaks something else.
  kUnreliable,        ///< Half of the messages or more fail their check.
  kSensorRate,        ///< A sensor sends at another rate than agreed.
  kAnotherStation,    ///< Someone else commands on this bus.
  kInterfaceMissing,  ///< The network interface of the bus is gone.
  kInterfaceDown,     ///< It is there and switched off.
  kBusOff,            ///< The controller has left the bus after too many errors.
  kBusErrors,         ///< The controller sees errors: wrong bit rate, wiring, termination.
  kNoAcknowledge,     ///< Nobody acknowledges what the station sends: it is alone on the bus.
  kPortMissing,       ///< The serial device is not there.
  kPortBusy,          ///< Another program has it.
  kPortPermission,    ///< The station may not use it.
  kPortSettings,      ///< It does not take 8N1 at the configured rate.
  kNotSerial,         ///< The path is something else than a serial device.
  kRealDevice,        ///< A real device or bus where only an emulated one is allowed.
  kNotCan,            ///< The interface is of another kind.
  kNoCan,             ///< The kernel has no CAN, or hides it from the station.
  kCanPermission,     ///< The station may not open CAN sockets.
  kCanSettings,       ///< The kernel refuses filters or time stamps.
  kPortFailed,        ///< It cannot be opened for another reason.
};
inline constexpr std::array<EnumName<LinkFault>, 23> kLinkFaultNames{
    {{LinkFault::kNone, "none"},
     {LinkFault::kSilent, "silent"},
     {LinkFault::kGarbage, "garbage"},
     {LinkFault::kOtherProtocol, "other protocol"},
     {LinkFault::kUnreliable, "unreliable"},
     {LinkFault::kSensorRate, "sensor rate"},
     {LinkFault::kAnotherStation, "another station"},
     {LinkFault::kInterfaceMissing, "interface missing"},
     {LinkFault::kInterfaceDown, "interface down"},
     {LinkFault::kBusOff, "bus-off"},
     {LinkFault::kBusErrors, "bus errors"},
     {LinkFault::kNoAcknowledge, "no acknowledge"},
     {LinkFault::kPortMissing, "port missing"},
     {LinkFault::kPortBusy, "port busy"},
     {LinkFault::kPortPermission, "port permission"},
     {LinkFault::kPortSettings, "port settings"},
     {LinkFault::kNotSerial, "not serial"},
     {LinkFault::kRealDevice, "real device"},
     {LinkFault::kNotCan, "not CAN"},
     {LinkFault::kNoCan, "no CAN"},
     {LinkFault::kCanPermission, "CAN permission"},
     {LinkFault::kCanSettings, "CAN settings"},
     {LinkFault::kPortFailed, "port failed"}}};

/// Counters of a device's link, for telemetry and arming checks. A line is a message of the
/// device's protocol, of text or not.
struct LinkStatus {
  bool connected{false};
  std::uint64_t bytes_in{0};
  std::uint64_t bytes_out{0};
  std::uint32_t lines_ok{0};
  std::uint32_t lines_bad{0};      ///< Cut, garbled, out of range or unknown.
  std::uint32_t bytes_dropped{0};  ///< Output that the port could not take.
  std::uint32_t reconnects{0};

  LinkFault fault{LinkFault::kNone};
  /// @name End-to-end checks, where the protocol has them; none of these messages is used
  /// @{
  std::uint32_t repeated{0};        ///< The same alive counter again.
  std::uint32_t wrong_sequence{0};  ///< Messages missing before it, or out of order.
  std::uint32_t check_errors{0};    ///< Wrong CRC, size or value.
  std::uint32_t timeouts{0};        ///< Times that a message was missing for three periods.
  /// @}
  /// @name The bus below them, where there is one
  /// @{
  std::uint32_t bus_errors{0};      ///< Error frames of a CAN controller.
  std::uint32_t bus_off{0};         ///< Times that it went off the bus.
  std::uint32_t frames_lost{0};     ///< Given up by the kernel because nobody read in time.
  std::uint32_t frames_foreign{0};  ///< Whole, and none of ours.
  std::uint32_t no_buffer{0};       ///< Frames that the kernel had no room to send.
  /// @}
};

/// Everything the core sees of the hardware in one cycle.
struct SensorFrame {
  Sample<ReelReading> reel;
  Sample<TetherAngles> angles;
  Sample<AttitudeReading> attitude;
  Sample<GimbalReading> gimbal;
  Sample<VehicleReading> vehicle;
  Sample<GroundReading> ground;
  LinkStatus link;
};

/// The vehicle says that it is in the air, on its way down included.
[[nodiscard]] inline bool isFlying(const SensorFrame& frame) noexcept {
  const VehiclePhase phase = frame.vehicle.value.phase;
  return frame.vehicle.sequence > 0 &&
         (phase == VehiclePhase::kFlying || phase == VehiclePhase::kLanding);
}

/// What the operator's sticks ask for: rates of the vehicle's own set-points, relative to the
/// active anchor, as in VehicleCommand.
struct TeleopRates {
  double length{0.0};        ///< dL/dt [m/s], pay-out positive.
  double elevation{0.0};     ///< d(theta)/dt [rad/s], up positive.
  double azimuth{0.0};       ///< d(phi)/dt [rad/s].
  double yaw{0.0};           ///< About +y [rad/s].
  double gimbal_pitch{0.0};  ///< Up positive [rad/s].
};

enum class VehicleAction : std::uint8_t {
  kNone,
  kTakeoff,    ///< Start motors and lift off; repeated by the supervisor until the vehicle says it
               ///< flies.
  kMotorStop,  ///< Motors off at once.
  kLand,       ///< Come down where you are, by yourself, and stop the motors there. A vehicle that
               ///< cannot does what the rates say.
};

/// What the station commands in one cycle. Rates are of the vehicle's own set-points, relative to
/// the active anchor.
struct VehicleCommand {
  bool engaged{false};            ///< False: nothing but zero rates may reach the device.
  double length_rate{0.0};        ///< dL/dt [m/s], pay-out positive.
  double elevation_rate{0.0};     ///< d(theta)/dt [rad/s], up positive.
  double azimuth_rate{0.0};       ///< d(phi)/dt [rad/s].
  double yaw_rate{0.0};           ///< About +y [rad/s].
  double gimbal_pitch_rate{0.0};  ///< Up positive [rad/s].
  bool reel_controller{
      false};  ///< Vehicle's own tether-length controller (off for take-off and landing).
  VehicleAction action{VehicleAction::kNone};
};

}  // namespace tautline
