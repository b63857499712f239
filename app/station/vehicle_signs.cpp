#include "app/station/vehicle_signs.h"

#include <array>

#include "drivers/fotokite_protocol.h"
#include "drivers/tautline_protocol.h"

namespace tautline {
namespace {

using C = Condition;

template <class Code, class Names>
constexpr VehicleSign sign(Code code, const Names& names, std::optional<Condition> condition,
                           const char* text, const char* remedy) {
  return {static_cast<std::uint16_t>(code), nameOf(code, names), condition, text, remedy};
}

namespace fk = fotokite;

constexpr VehicleSign flag(fk::FlightFlag code, std::optional<Condition> condition,
                           const char* text, const char* remedy) {
  return sign(code, fk::kFlightFlagNames, condition, text, remedy);
}
constexpr std::array kFotokiteFlags{
    flag(fk::kMissedTick, C::kVehicleWarning, "the flight controller missed a cycle",
         "land if it stays"),
    flag(fk::kI2cError, C::kVehicleWarning, "an error on the vehicle's internal bus",
         "land if it stays"),
    flag(fk::kCriticalBattery, C::kBatteryCritical, "the ground battery is critical",
         "change the battery"),
    flag(fk::kNoSyncCommands, C::kVehicleWarning, "the vehicle hears no commands and stands still",
         "check the link"),
    flag(fk::kLowLaunchAngle, C::kVehicleWarning, "the tether starts below the horizontal",
         "park the drone higher than the reel, or nearer to it"),
    flag(fk::kMotorError, C::kVehicleFault, "a motor reports an error",
         "examine motors and rotors"),
    flag(fk::kLowBattery, C::kBatteryLow, "the ground battery is low", "change the battery"),
    flag(fk::kLowBackupBattery, C::kBackupBatteryLow, "the vehicle's backup battery is low",
         "charge the backup battery"),
    flag(fk::kEmergencyLandFlag, C::kVehicleFault, "the vehicle lands by itself",
         "clear the ground below"),
    flag(fk::kNoTetherDetected, C::kTetherSlack, "the vehicle feels no tether",
         "reel in; look whether the tether is whole"),
    flag(fk::kHardKillFlag, C::kVehicleDanger, "the vehicle has cut its motors",
         "keep away; switch the vehicle off and examine it"),
    flag(fk::kForceSensorTemperatureInvalid, C::kVehicleWarning,
         "the tether force sensor's temperature is out of range", "let it warm up or cool down"),
    flag(fk::kFlyawayCandidate, C::kVehicleFault, "the vehicle moves as if nothing held it",
         "look whether the tether is whole"),
};
static_assert(kFotokiteFlags.size() == fk::kFlightFlagNames.size());

constexpr VehicleSign mode(fk::FlightMode code, std::optional<Condition> condition,
                           const char* text, const char* remedy) {
  return sign(code, fk::kFlightModeNames, condition, text, remedy);
}
constexpr std::array kFotokiteModes{
    mode(fk::FlightMode::kIdle, {}, "motors off", ""),
    mode(fk::FlightMode::kAngle, {}, "flying", ""),
    mode(fk::FlightMode::kAngleRate, {}, "flying", ""),
    mode(fk::FlightMode::kMotorLowLevel, C::kVehicleFault, "motors in maintenance mode",
         "leave the maintenance mode"),
    mode(fk::FlightMode::kEmergencyLand, C::kVehicleFault, "the vehicle lands by itself",
         "clear the ground below"),
    mode(fk::FlightMode::kMotorStopRestart, {}, "motors stopped", ""),
    mode(fk::FlightMode::kTimeout, C::kVehicleFault, "the vehicle gave up waiting for commands",
         "check the link; switch the vehicle off and on"),
    mode(fk::FlightMode::kMotorStopDisable, {}, "motors were stopped in the air", ""),
    mode(fk::FlightMode::kBatteryTooLow, C::kBatteryCritical, "the battery is too low to fly",
         "change the battery"),
    mode(fk::FlightMode::kNoTetherPower, C::kTetherPowerLost, "no power over the tether",
         "check tether and ground battery"),
    mode(fk::FlightMode::kHardKill, C::kVehicleDanger, "the vehicle has cut its motors",
         "keep away; switch the vehicle off and examine it"),
};
static_assert(kFotokiteModes.size() == fk::kFlightModeNames.size());

constexpr VehicleSign flag(bus::VehicleFlag code, std::optional<Condition> condition,
                           const char* text, const char* remedy) {
  return sign(code, bus::kVehicleFlagNames, condition, text, remedy);
}
constexpr std::array kTautlineFlags{
    flag(bus::kLowBattery, C::kBatteryLow, "the battery is low", "change the battery"),
    flag(bus::kCriticalBattery, C::kBatteryCritical, "the battery is critical",
         "change the battery"),
    flag(bus::kNoCommands, C::kVehicleWarning, "the vehicle hears no commands and stands still",
         "check the bus"),
    flag(bus::kSlackTether, C::kTetherSlack, "the vehicle feels no tether",
         "reel in; look whether the tether is whole"),
    flag(bus::kMotorFault, C::kVehicleFault, "a motor reports a fault",
         "examine motors and rotors"),
};
static_assert(kTautlineFlags.size() == bus::kVehicleFlagNames.size());

constexpr VehicleSign mode(bus::FlightMode code, std::optional<Condition> condition,
                           const char* text, const char* remedy) {
  return sign(code, bus::kFlightModeNames, condition, text, remedy);
}
constexpr std::array kTautlineModes{
    mode(bus::FlightMode::kIdle, {}, "motors off", ""),
    mode(bus::FlightMode::kFlying, {}, "flying", ""),
    mode(bus::FlightMode::kLanding, C::kVehicleFault, "the vehicle lands by itself",
         "clear the ground below"),
    mode(bus::FlightMode::kStopped, {}, "motors stopped", ""),
    mode(bus::FlightMode::kFault, C::kVehicleFault, "the vehicle reports a fault",
         "examine the vehicle"),
};
static_assert(kTautlineModes.size() == bus::kFlightModeNames.size());

}  // namespace

std::span<const VehicleSign> flagsOf(VehicleProtocol protocol) noexcept {
  switch (protocol) {
    case VehicleProtocol::kFotokite:
      return kFotokiteFlags;
    case VehicleProtocol::kTautline:
      return kTautlineFlags;
    case VehicleProtocol::kUnknown:
      break;
  }
  return {};
}

std::span<const VehicleSign> modesOf(VehicleProtocol protocol) noexcept {
  switch (protocol) {
    case VehicleProtocol::kFotokite:
      return kFotokiteModes;
    case VehicleProtocol::kTautline:
      return kTautlineModes;
    case VehicleProtocol::kUnknown:
      break;
  }
  return {};
}

ConditionSet conditionsOf(const VehicleReading& reading) noexcept {
  ConditionSet set;
  bool known_mode = false;
  forEachSign(reading, [&](const VehicleSign& shown) {
    if (shown.condition) set.set(*shown.condition);
  });
  for (const VehicleSign& m : modesOf(reading.protocol))
    known_mode = known_mode || m.code == reading.flight_mode;
  if (reading.protocol == VehicleProtocol::kUnknown)
    set.set(C::kVehicleFault, reading.phase == VehiclePhase::kFault);
  else if (!known_mode)
    set.set(C::kVehicleWarning);
  return set;
}

}  // namespace tautline
