#pragma once

/// @file
/// Names of the LCM channels and the place where Tautline's programs meet.

namespace tautline {

namespace channel {
inline constexpr const char* kStationInput = "STATION_INPUT";
inline constexpr const char* kStationState = "STATION_STATE";
inline constexpr const char* kSafety = "SAFETY";
inline constexpr const char* kTetherState = "TETHER_STATE";
inline constexpr const char* kVehicleState = "VEHICLE_STATE";
inline constexpr const char* kEstimate = "ESTIMATE";
inline constexpr const char* kCommand = "COMMAND";
inline constexpr const char* kMissionStatus = "MISSION_STATUS";
inline constexpr const char* kLogStatus = "LOG_STATUS";
inline constexpr const char* kLoopStats = "LOOP_STATS";
inline constexpr const char* kEvent = "EVENT";
inline constexpr const char* kOperatorCommand = "OPERATOR_COMMAND";
inline constexpr const char* kHeartbeat = "HEARTBEAT";
inline constexpr const char* kTeleop = "TELEOP";
inline constexpr const char* kAuthority = "AUTHORITY";
inline constexpr const char* kFaults = "FAULTS";
inline constexpr const char* kMissionChunk = "MISSION_CHUNK";
inline constexpr const char* kCommandAck = "COMMAND_ACK";
inline constexpr const char* kParams = "PARAMS";
inline constexpr const char* kSimTruth = "SIM_TRUTH";
inline constexpr const char* kSimFault = "SIM_FAULT";
}  // namespace channel

/// ttl=0 keeps the messages on this machine.
inline constexpr const char* kDefaultLcmUrl = "udpm://239.255.76.67:7667?ttl=0";

/// What to do where LCM finds no way for its multicast packets.
inline constexpr const char* kMulticastRemedy =
    "as root: ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo";

}  // namespace tautline
