#pragma once

/// @file
/// The Fotokite Pro ground station's "Remote Control" text protocol as constants: what the
/// station's codec and the simulator's own, independent encoder have to agree on. No code. Facts
/// and their sources: docs/devices.md.
///
/// Device to station: "!Pos 0.78,-0.52,1.20\r\n" (header, one space, fields separated by commas).
/// Station to device: "Pos2 0.100000,0.000000,120.000000\n" (name, one space, fields separated by
/// commas).

#include <array>
#include <cstdint>
#include <string_view>

#include "common/fields.h"

namespace tautline::fotokite {

inline constexpr int kDefaultBaud = 115200;  ///< 8N1. The device is USB CDC-ACM and takes any rate.

/// @name Telemetry headers
/// @{
inline constexpr std::string_view kGroundStatusHeader =
    "!GSStatus";  ///< mode, run time [s], battery [V], length [counts]
inline constexpr std::string_view kAttitudeHeader =
    "!Attitude";  ///< quaternion w,x,y,z, body to initialization frame
inline constexpr std::string_view kGimbalHeader =
    "!Gimbal";  ///< quaternion w,x,y,z, gimbal to initialization frame
inline constexpr std::string_view kPositionHeader =
    "!Pos";  ///< elevation from the vertical [rad], azimuth [rad], altitude [m]
inline constexpr std::string_view kFlightStatusHeader =
    "!FlightStatus";  ///< mode, on time [s], backup battery [V], flags
inline constexpr std::string_view kParamHeader = "!Param";  ///< answer to Pset; ignored
/// @}

/// @name Command names
/// @{
inline constexpr std::string_view kPosCommand =
    "Pos";  ///< elevation rate [rad/s], azimuth rate [rad/s], length change [counts]
inline constexpr std::string_view kPos2Command =
    "Pos2";  ///< elevation rate [rad/s], azimuth rate [rad/s], length rate [counts/s]
inline constexpr std::string_view kElevationCommand = "PosV";  ///< elevation rate [rad/s]
inline constexpr std::string_view kAzimuthCommand = "PosH";    ///< azimuth rate [rad/s]
inline constexpr std::string_view kLengthCommand = "PosL";     ///< length change [counts]
inline constexpr std::string_view kGimbalCommand =
    "Gimbal";  ///< pitch rate [rad/s], roll rate [rad/s]
inline constexpr std::string_view kGimbalPitchCommand = "GimbalPitch";
inline constexpr std::string_view kGimbalRollCommand = "GimbalRoll";
inline constexpr std::string_view kYawCommand = "Yaw";  ///< yaw rate [rad/s]
inline constexpr std::string_view kTakeoffCommand = "StartTakeoff";
inline constexpr std::string_view kMotorStopCommand = "MotorStop";
inline constexpr std::string_view kSetParameterCommand = "Pset";  ///< id, value
inline constexpr std::string_view kCommitCommand = "Pcommit";
inline constexpr std::string_view kStopCommand = "stop";  ///< leave remote control
/// @}

/// @name Limits the device puts on commands, symmetric about zero
/// @{
inline constexpr double kMaxElevationRate = 0.25;  ///< [rad/s]
inline constexpr double kMaxAzimuthRate = 0.2;     ///< [rad/s]
inline constexpr double kMaxYawRate = 0.4;         ///< [rad/s]
inline constexpr double kMaxGimbalRate = 0.3;      ///< [rad/s]
inline constexpr double kMaxReelRate = 10000.0;    ///< [counts/s]
/// @}

/// @name Reel
/// @{
inline constexpr double kMetresPerCount = 0.00285;  ///< Reference device; calibrate each one.
inline constexpr double kDeadZoneCentre =
    -160.0;  ///< Pos2 length rate at which the reel stands still [counts/s].
inline constexpr double kDeadZoneWidth =
    80.0;  ///< Nothing moves within half of this on either side [counts/s].
/// @}

/// @name Parameters (Pset id,value)
/// @{
inline constexpr int kTelemetryRateParameter =
    117;                                     ///< Attitude and position lines per second [Hz].
inline constexpr int kDebugParameter = 119;  ///< 0 = no debug output.
inline constexpr int kTetherControllerParameter = 79;  ///< 0 off (take-off, landing), 1 on.
inline constexpr double kDefaultTelemetryRate = 10.0;  ///< [Hz]; about 1 Hz without parameter 117.
inline constexpr double kTelemetryResolution =
    0.01;  ///< Of angles [rad], as the device rounds them.
/// @}

/// Brings the ground station into remote control. Then parameters 117 and 119, each followed by
/// Pcommit, then kSubscribe.
inline constexpr std::array<std::string_view, 9> kStartRemoteControl{
    "stop", "", "", "", "", "", "GSLowControl params 2 2", "RemoteControl start", "Checksum 0"};
inline constexpr std::array<std::string_view, 5> kSubscribe{
    "Get_GroundStatus 0", "Get_Att 0", "Get_Pos 0", "Get_FlightStatus 0", "Get_Gimbal 0"};

/// First field of !GSStatus.
enum class GroundMode : std::uint8_t { kIdle = 0, kMenu = 1, kScreen = 2, kRemoteControlled = 10 };

/// First field of !FlightStatus.
enum class FlightMode : std::uint8_t {
  kIdle = 1,
  kAngle = 2,
  kAngleRate = 3,
  kMotorLowLevel = 5,
  kEmergencyLand = 48,
  kMotorStopRestart = 49,
  kTimeout = 50,
  kMotorStopDisable = 52,
  kBatteryTooLow = 53,
  kNoTetherPower = 54,
  kHardKill = 55,
};

/// Last field of !FlightStatus, a bit set.
enum FlightFlag : std::uint16_t {
  kMissedTick = 1U << 0U,
  kI2cError = 1U << 1U,
  kCriticalBattery = 1U << 2U,
  kNoSyncCommands = 1U << 3U,
  kLowLaunchAngle = 1U << 4U,
  kMotorError = 1U << 5U,
  kLowBattery = 1U << 6U,
  kLowBackupBattery = 1U << 7U,
  kEmergencyLandFlag = 1U << 8U,
  kNoTetherDetected = 1U << 9U,
  kHardKillFlag = 1U << 10U,
  kForceSensorTemperatureInvalid = 1U << 11U,
  kFlyawayCandidate = 1U << 12U,
};
inline constexpr std::array<EnumName<FlightFlag>, 13> kFlightFlagNames{
    {{kMissedTick, "MISSED_TICK"},
     {kI2cError, "I2C_ERROR"},
     {kCriticalBattery, "CRIT_LOW_BATT"},
     {kNoSyncCommands, "NO_SYNC_CMDS"},
     {kLowLaunchAngle, "LOW_LAUNCH_ANGLE"},
     {kMotorError, "MOTOR_ERROR"},
     {kLowBattery, "LOW_BATT"},
     {kLowBackupBattery, "LOW_BACKUP_BATT"},
     {kEmergencyLandFlag, "EMERGENCY_LAND"},
     {kNoTetherDetected, "NO_TETHER_DETECTED"},
     {kHardKillFlag, "HARD_KILL"},
     {kForceSensorTemperatureInvalid, "OPTOFORCE_TEMP_INVALID"},
     {kFlyawayCandidate, "FLYAWAY_CANDIDATE"}}};

}  // namespace tautline::fotokite
