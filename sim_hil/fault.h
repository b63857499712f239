#pragma once

/// @file
/// What can be made to go wrong with the simulated machine: the menu of faults as data, and one
/// fault of it with its time and size. Which parts take them: fault_schedule.h, sensor_faults.h,
/// reel_faults.h, link_faults.h, frame_faults.h, Plant.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "common/error.h"
#include "common/fields.h"
#include "common/time.h"
#include "sim_hil/sim_config.h"

namespace tautline::sim {

/// What the fault is in.
enum class FaultTarget : std::uint8_t {
  kEncoder,
  kAngles,
  kAttitude,
  kBattery,
  kReel,
  kClock,        ///< The device's own.
  kVehicleLink,  ///< Bytes, both ways.
  kUplink,       ///< Bytes from the station only.
  kBus,          ///< Messages of the Tautline bus.
  kTether,
  kMotors,
  kAir,
  kFlag,          ///< A bit that the vehicle reports.
  kFlightMode,    ///< The mode that the vehicle reports.
  kOperatorLink,  ///< Between the operator and the station.
  kLcm,           ///< All of the station's messages.
  kLoop,          ///< The station's loop and clock.
  kDisk,
  kCamera,
};
inline constexpr std::array<EnumName<FaultTarget>, 19> kFaultTargetNames{
    {{FaultTarget::kEncoder, "encoder"},
     {FaultTarget::kAngles, "angles"},
     {FaultTarget::kAttitude, "attitude"},
     {FaultTarget::kBattery, "battery"},
     {FaultTarget::kReel, "reel"},
     {FaultTarget::kClock, "clock"},
     {FaultTarget::kVehicleLink, "link.vehicle"},
     {FaultTarget::kUplink, "link.uplink"},
     {FaultTarget::kBus, "bus"},
     {FaultTarget::kTether, "tether"},
     {FaultTarget::kMotors, "motors"},
     {FaultTarget::kAir, "air"},
     {FaultTarget::kFlag, "flag"},
     {FaultTarget::kFlightMode, "mode"},
     {FaultTarget::kOperatorLink, "link.operator"},
     {FaultTarget::kLcm, "lcm"},
     {FaultTarget::kLoop, "loop"},
     {FaultTarget::kDisk, "disk"},
     {FaultTarget::kCamera, "camera"}}};

/// How it is wrong. What that means for a target is in the menu.
enum class FaultMode : std::uint8_t {
  kOk,  ///< Nothing is wrong with the target, whatever else is scheduled for it.
  kOff,
  kStuck,
  kGarbage,
  kWrong,
  kSlow,
  kDelayed,
  kIntermittent,
  kSlack,
  kPayoutSlip,
  kSnag,
  kBreak,
  kContactSlip,
  kContactOff,
  kOverTension,
  kMotorWeak,
  kGust,
  kCrc,
  kDup,
  kReorder,
  kBusOff,
  kUnplug,
  kOn,  ///< Of a flag or a flight mode.
};
inline constexpr std::array<EnumName<FaultMode>, 23> kFaultModeNames{
    {{FaultMode::kOk, "ok"},
     {FaultMode::kOff, "off"},
     {FaultMode::kStuck, "stuck"},
     {FaultMode::kGarbage, "garbage"},
     {FaultMode::kWrong, "wrong"},
     {FaultMode::kSlow, "slow"},
     {FaultMode::kDelayed, "delayed"},
     {FaultMode::kIntermittent, "intermittent"},
     {FaultMode::kSlack, "slack"},
     {FaultMode::kPayoutSlip, "payout_slip"},
     {FaultMode::kSnag, "snag"},
     {FaultMode::kBreak, "break"},
     {FaultMode::kContactSlip, "contact_slip"},
     {FaultMode::kContactOff, "contact_off"},
     {FaultMode::kOverTension, "over_tension"},
     {FaultMode::kMotorWeak, "motor_weak"},
     {FaultMode::kGust, "gust"},
     {FaultMode::kCrc, "crc"},
     {FaultMode::kDup, "dup"},
     {FaultMode::kReorder, "reorder"},
     {FaultMode::kBusOff, "busoff"},
     {FaultMode::kUnplug, "unplug"},
     {FaultMode::kOn, "on"}}};

/// Who can make it happen.
enum class FaultPlace : std::uint8_t {
  kMachine,  ///< The simulated machine, whatever it is connected with.
  kBus,      ///< The simulated machine on the Tautline bus.
  kBench,    ///< The bench, which is operator as well and has the station in its hands.
  kNowhere,  ///< Nobody: the simulation has no such part.
};
inline constexpr std::array<EnumName<FaultPlace>, 4> kFaultPlaceNames{
    {{FaultPlace::kMachine, "tautline-sim, tautline-bench"},
     {FaultPlace::kBus, "both, on the Tautline bus"},
     {FaultPlace::kBench, "tautline-bench"},
     {FaultPlace::kNowhere, "unsupported"}}};

/// One line of the menu.
struct FaultKind {
  FaultTarget target;
  FaultMode mode;
  FaultPlace place;
  const char* effect;  ///< What happens; kNowhere: why it cannot.
  const char* value;   ///< What a fault's value is, with its unit; empty: it has none.
  double initial;      ///< Value of a fault that does not say one.
  Range range;
};

/// Every supported pair but `ok`, and those that are refused with a reason of their own.
[[nodiscard]] std::span<const FaultKind> faultMenu() noexcept;

/// Null for a pair that is not on the menu.
[[nodiscard]] const FaultKind* findFaultKind(FaultTarget target, FaultMode mode) noexcept;

/// A name of a flag or a flight mode and its code on each device; -1: the device has none.
struct VehicleCode {
  const char* name;
  int fotokite;
  int tautline;
};
[[nodiscard]] std::span<const VehicleCode> vehicleFlags() noexcept;
[[nodiscard]] std::span<const VehicleCode> vehicleFlightModes() noexcept;

/// One fault.
struct Fault {
  static constexpr Duration kForEver = std::chrono::hours(24 * 365);

  FaultTarget target{FaultTarget::kEncoder};
  FaultMode mode{FaultMode::kOk};
  std::size_t code{0};  ///< Index in vehicleFlags() or vehicleFlightModes().
  Time at{};            ///< On the machine's virtual clock.
  Duration lasting{kForEver};
  double value{0.0};                                  ///< FaultKind::value.
  Eigen::Vector3d velocity{Eigen::Vector3d::Zero()};  ///< Of a gust, in W [m/s].
};

/// Target and mode by name ("encoder", "stuck"; "flag:MOTOR_ERROR", "on") with the menu's value.
/// Throws InputError for what is not on the menu or not supported anywhere.
[[nodiscard]] Fault makeFault(std::string_view target, std::string_view mode);

/// "TARGET MODE AT_S [FOR_S [VALUE]]", times in seconds; a gust's value is X,Y,Z. FOR_S 0: for
/// ever. Throws InputError (usage).
[[nodiscard]] Fault parseFault(const std::string& text);

/// What parseFault() reads back as the same fault.
[[nodiscard]] std::string faultText(const Fault& fault);

/// Throws InputError if the fault's value is out of its range, or if a machine with this device, or
/// (`on_bench` false) without the bench around it, cannot have the fault.
void checkFault(const Fault& fault, SimDevice device, bool on_bench);

/// "encoder stuck", "flag:MOTOR_ERROR on".
[[nodiscard]] std::string describe(const Fault& fault);

/// How many faults a machine, and the bench around it, can have scheduled at once.
inline constexpr std::size_t kMaxFaults = 16;

/// What is said of a fault that is one too many.
[[nodiscard]] InputError tooManyFaults(const Fault& fault);

}  // namespace tautline::sim
