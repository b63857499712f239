#include "sim_hil/fault.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <vector>

#include "common/error.h"
#include "common/toml/toml_writer.h"
#include "drivers/fotokite_protocol.h"
#include "drivers/tautline_protocol.h"

namespace tautline::sim {
namespace {

using M = FaultMode;
using P = FaultPlace;
using T = FaultTarget;

constexpr Range kShare{0.0, 1.0};
constexpr Range kDelay{0.01, 2.0};
constexpr Range kPeriod{0.02, 60.0};
constexpr Range kNoValue{};

// clang-format off
constexpr std::array kMenu{
    FaultKind{T::kEncoder, M::kOff, P::kMachine, "its messages stop", "", 0, kNoValue},
    FaultKind{T::kEncoder, M::kStuck, P::kMachine, "repeats its last reading", "", 0, kNoValue},
    FaultKind{T::kEncoder, M::kGarbage, P::kMachine, "random readings within 50 m", "", 0, kNoValue},
    FaultKind{T::kEncoder, M::kWrong, P::kMachine, "reads too much", "metres more", 0.5, {-50, 50}},
    FaultKind{T::kEncoder, M::kSlow, P::kMachine, "sends seldom", "messages a second", 1.0, {0.1, 100}},
    FaultKind{T::kEncoder, M::kDelayed, P::kMachine, "old readings", "seconds late", 0.5, kDelay},
    FaultKind{T::kEncoder, M::kIntermittent, P::kMachine, "its messages come and go", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kAngles, M::kOff, P::kMachine, "their messages stop", "", 0, kNoValue},
    FaultKind{T::kAngles, M::kStuck, P::kMachine, "repeat their last reading", "", 0, kNoValue},
    FaultKind{T::kAngles, M::kGarbage, P::kMachine, "random directions", "", 0, kNoValue},
    FaultKind{T::kAngles, M::kWrong, P::kMachine, "read too much", "radians more, elevation and azimuth", 0.3, {-3, 3}},
    FaultKind{T::kAngles, M::kSlow, P::kMachine, "send seldom", "messages a second", 1.0, {0.1, 100}},
    FaultKind{T::kAngles, M::kDelayed, P::kMachine, "old readings", "seconds late", 0.5, kDelay},
    FaultKind{T::kAngles, M::kIntermittent, P::kMachine, "their messages come and go", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kAttitude, M::kOff, P::kMachine, "its messages stop", "", 0, kNoValue},
    FaultKind{T::kAttitude, M::kStuck, P::kMachine, "repeats its last reading", "", 0, kNoValue},
    FaultKind{T::kAttitude, M::kGarbage, P::kMachine, "random rotations", "", 0, kNoValue},
    FaultKind{T::kAttitude, M::kWrong, P::kMachine, "leans too far", "radians more, about x of W", 0.2, {-3, 3}},
    FaultKind{T::kAttitude, M::kSlow, P::kMachine, "sends seldom", "messages a second", 1.0, {0.1, 100}},
    FaultKind{T::kAttitude, M::kDelayed, P::kMachine, "old readings", "seconds late", 0.5, kDelay},
    FaultKind{T::kAttitude, M::kIntermittent, P::kMachine, "its messages come and go", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kBattery, M::kOff, P::kMachine, "the machine measures no voltage, and lands by itself", "", 0, kNoValue},
    FaultKind{T::kBattery, M::kStuck, P::kMachine, "the measured voltage stands still", "", 0, kNoValue},
    FaultKind{T::kBattery, M::kGarbage, P::kMachine, "random voltages up to twice the full one", "", 0, kNoValue},
    FaultKind{T::kBattery, M::kWrong, P::kMachine, "another voltage, with all that the machine makes of it", "volts more", -1.2, {-60, 60}},
    FaultKind{T::kBattery, M::kIntermittent, P::kMachine, "no voltage by turns", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kReel, M::kOff, P::kMachine, "the drum stands", "", 0, kNoValue},
    FaultKind{T::kReel, M::kStuck, P::kMachine, "the drum runs on as last commanded", "", 0, kNoValue},
    FaultKind{T::kReel, M::kGarbage, P::kMachine, "the drum turns at random", "largest m/s", 0.5, {0, 5}},
    FaultKind{T::kReel, M::kWrong, P::kMachine, "the drum multiplies its command", "factor", -1.0, {-10, 10}},
    FaultKind{T::kReel, M::kSlow, P::kMachine, "the drum is weak", "largest m/s", 0.05, {0, 5}},
    FaultKind{T::kReel, M::kDelayed, P::kMachine, "the drum follows late", "seconds late", 0.5, kDelay},
    FaultKind{T::kReel, M::kIntermittent, P::kMachine, "the drum stands by turns", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kReel, M::kSlack, P::kMachine, "the drum pays out without being asked", "m/s", 0.2, {-5, 5}},
    FaultKind{T::kReel, M::kPayoutSlip, P::kMachine, "the encoder counts, less tether follows", "share that does not follow", 0.5, kShare},
    FaultKind{T::kClock, M::kStuck, P::kMachine, "the device's clock stands, and all that it times", "", 0, kNoValue},
    FaultKind{T::kClock, M::kWrong, P::kMachine, "the device's clock jumps, once", "seconds forward", 10.0, {-1000, 1000}},
    FaultKind{T::kClock, M::kSlow, P::kMachine, "the device's clock runs at another speed", "times real time", 0.5, {0.01, 10}},
    FaultKind{T::kClock, M::kIntermittent, P::kMachine, "the device's clock stands by turns", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kVehicleLink, M::kOff, P::kMachine, "nothing passes, both ways", "", 0, kNoValue},
    FaultKind{T::kVehicleLink, M::kGarbage, P::kMachine, "bytes are damaged", "share of bytes", 0.02, kShare},
    FaultKind{T::kVehicleLink, M::kSlow, P::kMachine, "less gets through, the rest waits", "bytes a second each way", 500, {1, 1e6}},
    FaultKind{T::kVehicleLink, M::kDelayed, P::kMachine, "everything comes late, both ways", "seconds late", 0.5, kDelay},
    FaultKind{T::kVehicleLink, M::kIntermittent, P::kMachine, "nothing passes by turns", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kUplink, M::kOff, P::kMachine, "no command arrives", "", 0, kNoValue},
    FaultKind{T::kUplink, M::kGarbage, P::kMachine, "commands are damaged", "share of bytes", 0.02, kShare},
    FaultKind{T::kUplink, M::kSlow, P::kMachine, "fewer commands get through, the rest waits", "bytes a second", 500, {1, 1e6}},
    FaultKind{T::kUplink, M::kDelayed, P::kMachine, "commands come late", "seconds late", 0.5, kDelay},
    FaultKind{T::kUplink, M::kIntermittent, P::kMachine, "commands arrive by turns", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kBus, M::kCrc, P::kBus, "a bit of the data is inverted", "share of messages", 0.3, kShare},
    FaultKind{T::kBus, M::kDup, P::kBus, "messages come twice", "share of messages", 0.3, kShare},
    FaultKind{T::kBus, M::kReorder, P::kBus, "a message comes after the next of its kind", "share of messages", 0.3, kShare},
    FaultKind{T::kBus, M::kBusOff, P::kBus, "the devices neither send nor hear", "", 0, kNoValue},
    FaultKind{T::kBus, M::kUnplug, P::kMachine, "the cable is out of the station's port", "", 0, kNoValue},
    FaultKind{T::kTether, M::kSnag, P::kMachine, "the tether is held at a point", "where, as share of the length from the reel", 0.0, {0.0, 0.95}},
    FaultKind{T::kTether, M::kBreak, P::kMachine, "the tether is cut, for good", "where, as share of the length from the reel", 1.0, {0.05, 1.0}},
    FaultKind{T::kTether, M::kContactSlip, P::kMachine, "contacts slide along their edges", "friction that is left", 0.0, {0, 1.5}},
    FaultKind{T::kTether, M::kContactOff, P::kMachine, "obstacles hold the tether no more", "", 0, kNoValue},
    FaultKind{T::kTether, M::kOverTension, P::kMachine, "the vehicle pulls on the tether", "newtons", 5.0, {0, 50}},
    FaultKind{T::kMotors, M::kOff, P::kMachine, "all motors stop", "", 0, kNoValue},
    FaultKind{T::kMotors, M::kMotorWeak, P::kMachine, "less thrust", "share of the largest that is left", 0.6, kShare},
    FaultKind{T::kAir, M::kGust, P::kMachine, "wind of this velocity", "x,y,z in W, m/s", 0, {-20, 20}},
    FaultKind{T::kFlag, M::kOn, P::kMachine, "the vehicle reports it", "", 0, kNoValue},
    FaultKind{T::kFlightMode, M::kOn, P::kMachine, "the vehicle reports it, and does as before", "", 0, kNoValue},
    FaultKind{T::kOperatorLink, M::kOff, P::kBench, "the station hears no operator", "", 0, kNoValue},
    FaultKind{T::kOperatorLink, M::kDelayed, P::kBench, "commands reach the station late", "seconds late", 0.5, kDelay},
    FaultKind{T::kOperatorLink, M::kIntermittent, P::kBench, "the station hears the operator by turns", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kLcm, M::kOff, P::kBench, "no message of the station leaves or reaches it", "", 0, kNoValue},
    FaultKind{T::kLcm, M::kIntermittent, P::kBench, "messages pass by turns", "mean seconds of each", 0.5, kPeriod},
    FaultKind{T::kLoop, M::kDelayed, P::kBench, "every cycle of the station comes late", "seconds late", 0.05, kDelay},
    FaultKind{T::kLoop, M::kWrong, P::kBench, "the station's clock jumps, once", "seconds forward", 2.0, {0.01, 1000}},
    FaultKind{T::kDisk, M::kOff, P::kNowhere, "logs are written by another process, lcm-logger", "", 0, kNoValue},
    FaultKind{T::kCamera, M::kOff, P::kNowhere, "its video does not pass the device", "", 0, kNoValue},
};

namespace fk = fotokite;
constexpr std::array kFlags{
    VehicleCode{"MISSED_TICK", fk::kMissedTick, -1},
    VehicleCode{"I2C_ERROR", fk::kI2cError, -1},
    VehicleCode{"CRIT_LOW_BATT", fk::kCriticalBattery, bus::kCriticalBattery},
    VehicleCode{"NO_SYNC_CMDS", fk::kNoSyncCommands, bus::kNoCommands},
    VehicleCode{"LOW_LAUNCH_ANGLE", fk::kLowLaunchAngle, -1},
    VehicleCode{"MOTOR_ERROR", fk::kMotorError, bus::kMotorFault},
    VehicleCode{"LOW_BATT", fk::kLowBattery, bus::kLowBattery},
    VehicleCode{"LOW_BACKUP_BATT", fk::kLowBackupBattery, -1},
    VehicleCode{"EMERGENCY_LAND", fk::kEmergencyLandFlag, -1},
    VehicleCode{"NO_TETHER_DETECTED", fk::kNoTetherDetected, bus::kSlackTether},
    VehicleCode{"HARD_KILL", fk::kHardKillFlag, -1},
    VehicleCode{"OPTOFORCE_TEMP_INVALID", fk::kForceSensorTemperatureInvalid, -1},
    VehicleCode{"FLYAWAY_CANDIDATE", fk::kFlyawayCandidate, -1},
};

constexpr int code(fk::FlightMode mode) noexcept { return static_cast<int>(mode); }
constexpr int code(bus::FlightMode mode) noexcept { return static_cast<int>(mode); }
constexpr std::array kFlightModes{
    VehicleCode{"IDLE", code(fk::FlightMode::kIdle), code(bus::FlightMode::kIdle)},
    VehicleCode{"ANGLE", code(fk::FlightMode::kAngle), code(bus::FlightMode::kFlying)},
    VehicleCode{"ANGLE_RATE", code(fk::FlightMode::kAngleRate), -1},
    VehicleCode{"MOTOR_LOW_LEVEL", code(fk::FlightMode::kMotorLowLevel), -1},
    VehicleCode{"EMERGENCY_LAND", code(fk::FlightMode::kEmergencyLand), code(bus::FlightMode::kLanding)},
    VehicleCode{"MOTOR_STOP_RESTART", code(fk::FlightMode::kMotorStopRestart), -1},
    VehicleCode{"TIMEOUT", code(fk::FlightMode::kTimeout), -1},
    VehicleCode{"MOTOR_STOP_DISABLE", code(fk::FlightMode::kMotorStopDisable), code(bus::FlightMode::kStopped)},
    VehicleCode{"BATTERY_TOO_LOW", code(fk::FlightMode::kBatteryTooLow), -1},
    VehicleCode{"NO_TETHER_POWER", code(fk::FlightMode::kNoTetherPower), -1},
    VehicleCode{"HARD_KILL", code(fk::FlightMode::kHardKill), code(bus::FlightMode::kFault)},
};
// clang-format on

template <class Entries, class NameOf>
std::string listOf(const Entries& entries, const NameOf& name_of) {
  std::string list;
  for (const auto& entry : entries)
    list += (list.empty() ? "" : ", ") + std::string(name_of(entry));
  return list;
}

std::string modesOf(FaultTarget target) {
  std::string list = "ok";
  for (const FaultKind& kind : kMenu) {
    if (kind.target == target && kind.place != P::kNowhere)
      list += std::string(", ") + nameOf(kind.mode, kFaultModeNames);
  }
  return list;
}

std::span<const VehicleCode> codesOf(FaultTarget target) noexcept {
  if (target == T::kFlag) return kFlags;
  if (target == T::kFlightMode) return kFlightModes;
  return {};
}

template <class Names>
auto find(std::string_view name, const Names& names) noexcept {
  return std::find_if(names.begin(), names.end(), [&](const auto& n) { return name == n.name; });
}

double number(const std::string& word, const char* key) {
  double value = 0.0;
  const auto done = std::from_chars(word.data(), word.data() + word.size(), value);
  if (done.ec == std::errc{} && done.ptr == word.data() + word.size() &&
      Range{-1e9, 1e9}.contains(value))
    return value;
  throw InputError({.key = key,
                    .problem = "\"" + word + "\" is no number",
                    .allowed = "TARGET MODE AT_S [FOR_S [VALUE]], e.g. encoder stuck 10 5"},
                   ExitCode::kUsage);
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c != separator) {
      words.back() += c;
    } else if (separator != ' ' || !words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

}  // namespace

std::span<const FaultKind> faultMenu() noexcept { return kMenu; }
std::span<const VehicleCode> vehicleFlags() noexcept { return kFlags; }
std::span<const VehicleCode> vehicleFlightModes() noexcept { return kFlightModes; }

const FaultKind* findFaultKind(FaultTarget target, FaultMode mode) noexcept {
  const auto* const found = std::find_if(kMenu.begin(), kMenu.end(), [&](const FaultKind& k) {
    return k.target == target && k.mode == mode;
  });
  return found == kMenu.end() ? nullptr : found;
}

Fault makeFault(std::string_view target, std::string_view mode) {
  Fault fault;
  const std::size_t colon = std::min(target.find(':'), target.size());
  const auto* const named = find(target.substr(0, colon), kFaultTargetNames);
  if (named == kFaultTargetNames.end()) {
    throw InputError({.key = "target",
                      .problem = "\"" + std::string(target) + "\" is none",
                      .allowed = listOf(kFaultTargetNames, [](const auto& n) { return n.name; }),
                      .remedy = "see `tautline-sim faults`"});
  }
  fault.target = named->value;
  if (const std::span<const VehicleCode> codes = codesOf(fault.target); !codes.empty()) {
    const auto found =
        find(colon < target.size() ? target.substr(colon + 1) : std::string_view{}, codes);
    if (found == codes.end()) {
      throw InputError({.key = "target",
                        .problem = "\"" + std::string(target) + "\" is none",
                        .allowed = std::string(named->name) + ":NAME with NAME one of " +
                                   listOf(codes, [](const VehicleCode& c) { return c.name; })});
    }
    fault.code = static_cast<std::size_t>(found - codes.begin());
  } else if (colon < target.size()) {
    throw InputError({.key = "target",
                      .problem = "\"" + std::string(target) + "\" has a name behind its colon",
                      .allowed = "names behind flag: and mode: only"});
  }
  const auto* const how = find(mode, kFaultModeNames);
  const FaultKind* kind =
      how == kFaultModeNames.end() ? nullptr : findFaultKind(fault.target, how->value);
  if (kind == nullptr && mode != "ok") {
    const bool any = modesOf(fault.target) != "ok";
    throw InputError({.key = "mode",
                      .problem = "\"" + std::string(named->name) + " " + std::string(mode) +
                                 "\" is not supported",
                      .allowed = any ? modesOf(fault.target) : "",
                      .remedy = "see `tautline-sim faults`"});
  }
  fault.mode = how->value;
  if (kind != nullptr) fault.value = kind->initial;
  if (kind != nullptr && kind->place == P::kNowhere) {
    throw InputError({.key = "target",
                      .problem = describe(fault) + " is not supported: " + kind->effect,
                      .remedy = "see `tautline-sim faults`"});
  }
  return fault;
}

Fault parseFault(const std::string& text) {
  const std::vector<std::string> words = split(text, ' ');
  if (words.size() < 3 || words.size() > 5) {
    throw InputError({.key = "--fault",
                      .problem = "\"" + text + "\" has " + std::to_string(words.size()) + " words",
                      .allowed = "TARGET MODE AT_S [FOR_S [VALUE]], e.g. encoder stuck 10 5"},
                     ExitCode::kUsage);
  }
  Fault fault;
  try {
    fault = makeFault(words[0], words[1]);
  } catch (const InputError& e) {
    throw InputError(e.problem(), ExitCode::kUsage);
  }
  fault.at = Time{} + fromSeconds(number(words[2], "AT_S"));
  if (words.size() > 3) {
    const double lasting = number(words[3], "FOR_S");
    if (lasting > 0.0) fault.lasting = fromSeconds(lasting);
  }
  if (words.size() > 4) {
    const std::vector<std::string> parts = split(words[4], ',');
    fault.value = number(parts.empty() ? "" : parts[0], "VALUE");
    if (fault.mode == M::kGust) {
      if (parts.size() != 3) {
        throw InputError({.key = "VALUE",
                          .problem = "\"" + words[4] + "\" is no velocity",
                          .allowed = "X,Y,Z in metres per second, W"},
                         ExitCode::kUsage);
      }
      for (int i = 0; i < 3; ++i)
        fault.velocity[i] = number(parts[static_cast<std::size_t>(i)], "VALUE");
    }
  }
  return fault;
}

std::string faultText(const Fault& fault) {
  const double lasting = fault.lasting < Fault::kForEver ? toSeconds(fault.lasting) : 0.0;
  const std::string text =
      describe(fault) + " " + tomlText(toSeconds(fault.at - Time{})) + " " + tomlText(lasting);
  if (fault.mode == M::kGust) {
    const Eigen::Vector3d& v = fault.velocity;
    return text + " " + tomlText(v.x()) + "," + tomlText(v.y()) + "," + tomlText(v.z());
  }
  const FaultKind* kind = findFaultKind(fault.target, fault.mode);
  const bool sized = kind != nullptr && kind->value[0] != '\0';
  return sized ? text + " " + tomlText(fault.value) : text;
}

void checkFault(const Fault& fault, SimDevice device, bool on_bench) {
  if (fault.mode == M::kOk) return;
  const FaultKind* kind = findFaultKind(fault.target, fault.mode);
  const auto refuse = [&](const std::string& why, const std::string& remedy) {
    throw InputError({.key = describe(fault), .problem = why, .remedy = remedy});
  };
  TAUTLINE_CHECK(kind != nullptr);
  const char* device_name = nameOf(device, kSimDeviceNames);
  if (kind->place == P::kBench && !on_bench)
    refuse("is not in the machine", "fly it with tautline-bench scenario");
  if (kind->place == P::kBus && device == SimDevice::kFotokite)
    refuse(std::string("the device \"") + device_name + "\" has no such bus",
           "use device tautline-serial");
  const bool own_cable = device == SimDevice::kFotokite || device == SimDevice::kTautlineSerial;
  if (kind->mode == M::kUnplug && !own_cable)
    refuse(std::string("the cable of the device \"") + device_name + "\" is not the simulator's",
           "use device fotokite or tautline-serial");
  if (const auto codes = codesOf(fault.target); !codes.empty()) {
    const VehicleCode& c = codes[fault.code];
    if ((device == SimDevice::kFotokite ? c.fotokite : c.tautline) < 0)
      refuse(std::string("the device \"") + device_name + "\" cannot report it", "");
  }
  const double size = fault.mode == M::kGust ? fault.velocity.cwiseAbs().maxCoeff() : fault.value;
  if (kind->value[0] != '\0' && !kind->range.contains(size)) {
    char allowed[96];
    std::snprintf(allowed, sizeof allowed, "%g to %g (%s)", kind->range.min, kind->range.max,
                  kind->value);
    throw InputError({.key = "value",
                      .problem = describe(fault) + " cannot be " + std::to_string(size),
                      .allowed = allowed});
  }
}

std::string describe(const Fault& fault) {
  std::string text = nameOf(fault.target, kFaultTargetNames);
  if (const auto codes = codesOf(fault.target); !codes.empty())
    text += std::string(":") + codes[fault.code].name;
  return text + " " + nameOf(fault.mode, kFaultModeNames);
}

InputError tooManyFaults(const Fault& fault) {
  return InputError({.key = describe(fault),
                     .problem = "too many faults at once",
                     .allowed = "at most " + std::to_string(kMaxFaults)});
}

}  // namespace tautline::sim
