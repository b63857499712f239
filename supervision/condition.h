#pragma once

/// @file
/// What can be the case in a cycle, as bits, and all that is known about each in one table: name,
/// text, unit of its measured value, remedy, guard and recovery time. The supervisor's table, the
/// arming checks, telemetry, `tautline status` and docs/operator_guide.md read this one.

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>

#include "common/fields.h"

namespace tautline {

enum class Condition : std::uint8_t {
  // Sensors.
  kReelStale,
  kReelStuck,
  kReelJump,
  kAnglesStale,
  kAnglesStuck,
  kAnglesJump,
  kAttitudeStale,
  kVehicleStale,
  // Link.
  kLinkLost,
  kLinkFault,
  kCrcRate,
  // Estimate and tether.
  kLocalizationLost,
  kTensionUnobservable,
  kTetherSlack,
  kOverTension,
  kReelLimit,
  kTetherSnagged,
  kTetherBroken,
  kUnplannedContact,
  kContactLost,
  kContactNotFormed,
  kContactSlipped,
  kReelScale,
  kOscillation,
  kElevationHigh,
  // Fence.
  kFenceLength,
  kFenceAltitude,
  kFenceElevation,
  kFenceKeepOut,
  kFenceClearance,
  // Power.
  kBatteryLow,
  kBatteryCritical,
  kBackupBatteryLow,
  kTetherPowerLost,
  // Vehicle: what its flags and flight modes ask for, by the table of docs/devices.md.
  kVehicleWarning,
  kVehicleFault,
  kVehicleDanger,
  kVehicleFlying,
  // Progress of what is flown.
  kAtTarget,
  kTouchdown,
  kMissionLoaded,
  kMissionBad,
  kTetherElsewhere,
  kMissionDone,
  kMissionFailed,
  kNoWayBack,
  kTimeInMode,
  // Operator.
  kNoOperator,
  kOperatorLost,
  kTeleopStale,
  kSticksMoved,
  // Station.
  kOverruns,
  kLoopJitter,
  kClockJump,
  kRealTimeMissing,
  kLogOff,
  kDiskLow,
  kConfigBad,
  kLengthUncalibrated,
  kAzimuthUncalibrated,
  kSimMismatch,
  kFaultLatched,
};

/// What a condition is for.
enum class ConditionKind : std::uint8_t {
  kFact,           ///< Neither good nor bad; rows of the table need it.
  kWarns,          ///< Told, and acted on by nobody but the operator.
  kInFlight,       ///< Acted on in flight; cannot be there before.
  kForbidsArming,  ///< An arming check, and acted on in flight.
};

struct ConditionInfo {
  Condition condition;
  const char* name;  ///< In telemetry, on screens and in scenario files.
  ConditionKind kind;
  const char* unit;   ///< Of its measured value and limit; empty: it has none.
  double guard_s;     ///< It must last this long before it counts [s].
  double recovery_s;  ///< And be gone this long before it no longer does [s].
  const char* text;
  const char* remedy;
};

inline constexpr auto kConditionInfos = std::to_array<ConditionInfo>({
    {Condition::kReelStale, "ENCODER_STALE", ConditionKind::kForbidsArming, "s", 0.0, 0.5,
     "no usable tether length in time", "check the reel's cable and its telemetry rate"},
    {Condition::kReelStuck, "ENCODER_STUCK", ConditionKind::kForbidsArming, "m", 0.0, 2.0,
     "the tether length does not follow what is commanded",
     "look at the encoder's wheel; `tautline doctor` tests the line"},
    {Condition::kReelJump, "ENCODER_JUMP", ConditionKind::kForbidsArming, "m", 0.0, 2.0,
     "the tether length jumped farther than the reel can move",
     "look at the encoder; restart the ground station on the ground"},
    {Condition::kAnglesStale, "ANGLES_STALE", ConditionKind::kForbidsArming, "s", 0.0, 0.5,
     "no usable tether angles in time", "check the angle sensor's cable and its telemetry rate"},
    {Condition::kAnglesStuck, "ANGLES_STUCK", ConditionKind::kForbidsArming, "rad", 0.0, 2.0,
     "the tether angles do not follow what is commanded",
     "look whether the angle sensor moves freely"},
    {Condition::kAnglesJump, "ANGLES_JUMP", ConditionKind::kForbidsArming, "rad", 0.0, 2.0,
     "the tether angles jumped farther than the vehicle can move",
     "look at the angle sensor and its cable"},
    {Condition::kAttitudeStale, "ATTITUDE_STALE", ConditionKind::kForbidsArming, "s", 0.0, 0.5,
     "no usable attitude in time", "check the vehicle's telemetry rate"},
    {Condition::kVehicleStale, "VEHICLE_STALE", ConditionKind::kForbidsArming, "s", 0.0, 0.5,
     "no status from the vehicle in time",
     "check the vehicle's power and its link to the ground station"},
    {Condition::kLinkLost, "LINK_VEHICLE", ConditionKind::kForbidsArming, "", 0.0, 0.5,
     "the device is not connected", "check that it is plugged in and powered"},
    {Condition::kLinkFault, "LINK_FAULT", ConditionKind::kForbidsArming, "", 0.0, 0.5,
     "something is wrong with a link that is there", "see the link's line in `tautline status`"},
    {Condition::kCrcRate, "CRC_RATE", ConditionKind::kForbidsArming, "", 0.0, 2.0,
     "too many messages of the device fail their check", "check cable, ground and termination"},
    {Condition::kLocalizationLost, "LOCALIZATION_LOST", ConditionKind::kForbidsArming, "", 0.0, 0.5,
     "the position must not be acted on",
     "wait for it to come back; back up along the path; `tautline land`"},
    {Condition::kTensionUnobservable, "TENSION_NOMINAL", ConditionKind::kWarns, "rad", 1.0, 1.0,
     "the lean tells nothing of the tension; its nominal value is used",
     "nothing to do; it comes back away from the pole"},
    {Condition::kTetherSlack, "TETHER_SLACK", ConditionKind::kForbidsArming, "m", 1.0, 2.0,
     "the tether is longer than the way it spans", "reel in; look whether it lies on the ground"},
    {Condition::kOverTension, "OVER_TENSION", ConditionKind::kInFlight, "N", 0.3, 1.0,
     "the tether pulls harder than allowed", "look what holds it; do not reel in"},
    {Condition::kReelLimit, "REEL_LIMIT", ConditionKind::kForbidsArming, "m", 0.0, 0.5,
     "the tether is at the length of the reel",
     "come nearer; raise core.limits if the reel holds more"},
    {Condition::kTetherSnagged, "TETHER_SNAGGED", ConditionKind::kInFlight, "N", 0.0, 3.0,
     "the tether is caught: commanded, not moving, and it pulls",
     "free it by hand, or back up; do not land before"},
    {Condition::kTetherBroken, "TETHER_BROKEN", ConditionKind::kInFlight, "N", 0.0, 10.0,
     "no pull on the tether and its length does not follow", "clear the ground below"},
    {Condition::kUnplannedContact, "UNPLANNED_CONTACT", ConditionKind::kInFlight, "", 0.0, 2.0,
     "the tether touches something that the mission does not know",
     "`tautline backup`, or free it by hand"},
    {Condition::kContactLost, "CONTACT_LOST", ConditionKind::kInFlight, "", 0.0, 1.0,
     "the tether has come off the contact that the mission counts on",
     "`tautline backup` with the tether in sight, or land by hand"},
    {Condition::kContactNotFormed, "CONTACT_NOT_FORMED", ConditionKind::kInFlight, "", 0.0, 1.0,
     "the contact that the mission has made is not there: the tether goes straight on",
     "`tautline backup`; look on which side of the obstacle the tether passes"},
    {Condition::kContactSlipped, "CONTACT_SLIPPED", ConditionKind::kWarns, "m", 0.0, 2.0,
     "the tether has slid along the edge of its contact; the position is off by as much",
     "`tautline backup` undoes the contact; fly on only with room to spare"},
    {Condition::kReelScale, "REEL_SCALE", ConditionKind::kWarns, "", 0.0, 2.0,
     "the reel's scale is not the calibrated one",
     "calibrate the reel with two marks: docs/devices.md"},
    {Condition::kOscillation, "OSCILLATION", ConditionKind::kInFlight, "m", 0.0, 3.0,
     "the drone swings about its path", "wait for it to calm down; then lower the speed"},
    {Condition::kElevationHigh, "ELEVATION_HIGH", ConditionKind::kWarns, "rad", 0.2, 1.0,
     "above the elevation that the Jacobian law can fly",
     "nothing to do; the composite law flies through"},
    {Condition::kFenceLength, "FENCE_LENGTH", ConditionKind::kForbidsArming, "m", 0.0, 1.0,
     "more tether out than the fence allows", "come nearer; core.fence.max_length_m"},
    {Condition::kFenceAltitude, "FENCE_ALTITUDE", ConditionKind::kForbidsArming, "m", 0.0, 1.0,
     "above or below the fence", "come back inside; core.fence.min_height_m, max_height_m"},
    {Condition::kFenceElevation, "FENCE_ELEVATION", ConditionKind::kInFlight, "rad", 0.0, 1.0,
     "outside the fence's elevation cone",
     "come back inside; core.fence.min_elevation_rad, max_elevation_rad"},
    {Condition::kFenceKeepOut, "FENCE_KEEP_OUT", ConditionKind::kForbidsArming, "m", 0.0, 1.0,
     "inside a keep-out box", "come back inside; core.fence.keep_out"},
    {Condition::kFenceClearance, "FENCE_CLEARANCE", ConditionKind::kInFlight, "m", 0.0, 1.0,
     "nearer to an obstacle of the map than the fence allows",
     "move away from it; core.fence.min_clearance_m"},
    {Condition::kBatteryLow, "BATTERY", ConditionKind::kForbidsArming, "V", 1.0, 5.0,
     "the battery is low", "land and change it"},
    {Condition::kBatteryCritical, "BATTERY_CRITICAL", ConditionKind::kForbidsArming, "V", 1.0, 10.0,
     "the battery is critical", "nothing to do: it lands"},
    {Condition::kBackupBatteryLow, "BACKUP_BATTERY", ConditionKind::kForbidsArming, "V", 1.0, 5.0,
     "the vehicle's backup battery is low", "land and charge it"},
    {Condition::kTetherPowerLost, "TETHER_POWER", ConditionKind::kForbidsArming, "", 0.3, 5.0,
     "no power over the tether: flying from the backup battery", "nothing to do: it lands"},
    {Condition::kVehicleWarning, "VEHICLE_WARNING", ConditionKind::kWarns, "", 0.0, 1.0,
     "the vehicle warns", "see its flags in `tautline status`"},
    {Condition::kVehicleFault, "VEHICLE_FAULT", ConditionKind::kForbidsArming, "", 0.0, 1.0,
     "the vehicle reports a fault that asks for landing",
     "see flight mode and flags in `tautline status`"},
    {Condition::kVehicleDanger, "VEHICLE_DANGER", ConditionKind::kForbidsArming, "", 0.2, 1.0,
     "the vehicle reports a fault in which rotors must not run",
     "keep away until the rotors stand"},
    {Condition::kVehicleFlying, "NOT_LANDED", ConditionKind::kForbidsArming, "", 0.0, 0.0,
     "the vehicle says that it flies", "`tautline hold` or `tautline land` takes it back"},
    {Condition::kAtTarget, "AT_TARGET", ConditionKind::kFact, "", 0.0, 0.0,
     "the present take-off, way back or landing is at its target", ""},
    {Condition::kTouchdown, "TOUCHDOWN", ConditionKind::kFact, "", 0.0, 0.0,
     "on the ground at the end of a landing", ""},
    {Condition::kMissionLoaded, "MISSION_LOADED", ConditionKind::kFact, "", 0.0, 0.0,
     "a complete, valid mission is in memory", ""},
    {Condition::kMissionBad, "MISSION_BAD", ConditionKind::kFact, "", 0.0, 0.0,
     "a part of a mission is missing or wrong", "send it again: `tautline navigate FILE`"},
    {Condition::kTetherElsewhere, "TETHER_ELSEWHERE", ConditionKind::kFact, "", 0.0, 0.0,
     "the loaded mission begins with another contact than the tether now has",
     "fly a mission that begins with it, or go home first"},
    {Condition::kMissionDone, "MISSION_DONE", ConditionKind::kFact, "", 0.0, 0.0,
     "the mission is completed", ""},
    {Condition::kMissionFailed, "NO_PROGRESS", ConditionKind::kInFlight, "", 0.0, 0.0,
     "the route was given up: time-out, no progress, bad contact or out of reach",
     "look whether the tether is caught; then navigate again or land"},
    {Condition::kNoWayBack, "NO_WAY_BACK", ConditionKind::kFact, "", 0.0, 0.0,
     "how the drone came to where it is, is not known", "`tautline land` goes straight home"},
    {Condition::kTimeInMode, "TIME_IN_MODE", ConditionKind::kFact, "s", 0.0, 0.0,
     "the present mode has lasted longer than it may", ""},
    {Condition::kNoOperator, "NO_OPERATOR", ConditionKind::kForbidsArming, "s", 0.0, 0.0,
     "nobody holds the lease", "`tautline arm` takes it"},
    {Condition::kOperatorLost, "OPERATOR_LOST", ConditionKind::kInFlight, "s", 0.0, 0.0,
     "no heartbeat of the operator who holds the lease",
     "check the network; any station of an operator may take over"},
    {Condition::kTeleopStale, "TELEOP_STALE", ConditionKind::kInFlight, "s", 0.0, 0.0,
     "no fresh stick command", "press a key, or `tautline hold`"},
    {Condition::kSticksMoved, "STICKS_MOVED", ConditionKind::kFact, "", 0.0, 0.0,
     "the sticks were moved beyond their dead band while the mission flies",
     "fly it by hand, or `tautline navigate` again"},
    {Condition::kOverruns, "OVERRUNS", ConditionKind::kForbidsArming, "", 0.0, 1.0,
     "the loop has missed several periods in a row", "free the machine, or lower loop_rate_hz"},
    {Condition::kLoopJitter, "LOOP_JITTER", ConditionKind::kForbidsArming, "s", 0.0, 5.0,
     "the loop wakes up too late", "`tautline doctor --rt` says why"},
    {Condition::kClockJump, "CLOCK", ConditionKind::kForbidsArming, "s", 0.0, 5.0,
     "the clock has jumped, or a cycle took very long", "`tautline doctor` tests the clock"},
    {Condition::kRealTimeMissing, "RT_PRIORITY", ConditionKind::kForbidsArming, "", 0.0, 0.0,
     "the loop has no real-time priority, and the configuration asks for it",
     "`tautline doctor --rt` prints the command"},
    {Condition::kLogOff, "LOG_OFF", ConditionKind::kForbidsArming, "s", 3.0, 0.0,
     "nobody records a log", "start `tautline log record`"},
    {Condition::kDiskLow, "DISK", ConditionKind::kForbidsArming, "byte", 0.0, 5.0,
     "little space for logs", "remove old logs; `tautline log record --quota`"},
    {Condition::kConfigBad, "CONFIG", ConditionKind::kForbidsArming, "", 0.0, 0.0,
     "the configuration is not that of a flight", "`tautline-station --check-config`"},
    {Condition::kLengthUncalibrated, "CALIB_LENGTH", ConditionKind::kForbidsArming, "m", 0.0, 0.0,
     "with the drone parked, the tether length is not that of home",
     "put the drone on its place, or zero the reel: docs/devices.md"},
    {Condition::kAzimuthUncalibrated, "CALIB_AZIMUTH", ConditionKind::kForbidsArming, "rad", 0.0,
     0.0, "with the drone parked, the azimuth is not that of home",
     "put the drone on its place, or set the azimuth's zero: docs/devices.md"},
    {Condition::kSimMismatch, "SIM_MISMATCH", ConditionKind::kForbidsArming, "", 0.0, 0.0,
     "a simulated run on a real device, or the reverse", "set run_mode to what is plugged in"},
    {Condition::kFaultLatched, "FAULT_LATCHED", ConditionKind::kForbidsArming, "", 0.0, 0.0,
     "a fault of the last flight needs a look",
     "look at `tautline faults`; `tautline disarm` clears it"},
});
inline constexpr std::size_t kConditionCount = kConditionInfos.size();
static_assert(kConditionCount <= 64, "a set of conditions is one word");

/// Everything about one condition. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] constexpr const ConditionInfo& infoOf(Condition c) noexcept {
  return kConditionInfos[static_cast<std::size_t>(c)];
}
static_assert(
    [] {
      for (std::size_t i = 0; i < kConditionCount; ++i)
        if (kConditionInfos[i].condition != static_cast<Condition>(i)) return false;
      return true;
    }(),
    "rows in the order of the enumeration");

/// The names alone, for whoever reads or lists them (common/fields.h).
inline constexpr auto kConditionNames = [] {
  std::array<EnumName<Condition>, kConditionCount> names{};
  for (std::size_t i = 0; i < kConditionCount; ++i)
    names[i] = {kConditionInfos[i].condition, kConditionInfos[i].name};
  return names;
}();

/// A set of conditions. Real-time safe: no allocation, no locks, no exceptions.
class ConditionSet {
 public:
  constexpr ConditionSet() noexcept = default;
  constexpr ConditionSet(std::initializer_list<Condition> list) noexcept {
    for (const Condition c : list) set(c);
  }
  constexpr void set(Condition c, bool on = true) noexcept {
    bits_ = on ? bits_ | bit(c) : bits_ & ~bit(c);
  }
  [[nodiscard]] constexpr bool has(Condition c) const noexcept { return (bits_ & bit(c)) != 0; }
  [[nodiscard]] constexpr bool any(ConditionSet s) const noexcept { return (bits_ & s.bits_) != 0; }
  [[nodiscard]] constexpr bool all(ConditionSet s) const noexcept {
    return (bits_ & s.bits_) == s.bits_;
  }
  [[nodiscard]] constexpr bool empty() const noexcept { return bits_ == 0; }
  [[nodiscard]] constexpr ConditionSet operator&(ConditionSet s) const noexcept {
    return fromBits(bits_ & s.bits_);
  }
  [[nodiscard]] constexpr ConditionSet operator|(ConditionSet s) const noexcept {
    return fromBits(bits_ | s.bits_);
  }
  [[nodiscard]] constexpr ConditionSet without(ConditionSet s) const noexcept {
    return fromBits(bits_ & ~s.bits_);
  }
  [[nodiscard]] constexpr std::uint64_t bits() const noexcept { return bits_; }
  [[nodiscard]] static constexpr ConditionSet fromBits(std::uint64_t bits) noexcept {
    ConditionSet s;
    s.bits_ = bits;
    return s;
  }
  friend constexpr bool operator==(ConditionSet a, ConditionSet b) noexcept = default;

 private:
  static constexpr std::uint64_t bit(Condition c) noexcept {
    return std::uint64_t{1} << static_cast<unsigned>(c);
  }
  std::uint64_t bits_{0};
};

/// All conditions of one kind.
[[nodiscard]] constexpr ConditionSet conditionsOf(ConditionKind kind) noexcept {
  ConditionSet set;
  for (const ConditionInfo& info : kConditionInfos)
    if (info.kind == kind) set.set(info.condition);
  return set;
}

/// Names of the conditions in `set`, separated by blanks. Not real-time safe: displays only.
[[nodiscard]] std::string describe(ConditionSet set);

}  // namespace tautline
