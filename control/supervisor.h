#pragma once

/// @file
/// Decides what the station may do: modes, condition bits and one ordered table of transitions
/// (docs/supervisor.md). A pure function of conditions, request and time; it knows nothing of
/// sensors or controllers.

#include <array>
#include <cstdint>
#include <initializer_list>
#include <string>

#include "common/fields.h"
#include "common/time.h"

namespace tautline {

enum class Mode : std::uint8_t {
  kStandby,  ///< Disarmed. Every start comes up here.
  kArmed,    ///< Ready to take off, motors off.
  kTakeoff,  ///< Motors on, climbing to the hover point above home.
  kHold,     ///< Hovering where it was when the mode began.
  kAuto,     ///< Flying the mission.
  kLand,     ///< Going home, descending, stopping the motors.
  kEstop,    ///< Motors off, latched until disarmed by the operator.
};
inline constexpr std::array<EnumName<Mode>, 7> kModeNames{{{Mode::kStandby, "STANDBY"},
                                                           {Mode::kArmed, "ARMED"},
                                                           {Mode::kTakeoff, "TAKEOFF"},
                                                           {Mode::kHold, "HOLD"},
                                                           {Mode::kAuto, "AUTO"},
                                                           {Mode::kLand, "LAND"},
                                                           {Mode::kEstop, "ESTOP"}}};

/// What is the case in a cycle. Bits, so that a set of them is one word in telemetry.
enum class Condition : std::uint8_t {
  kReelStale,         ///< No usable tether length sample in time.
  kAnglesStale,       ///< No usable tether angle sample in time.
  kAttitudeStale,     ///< No usable attitude sample in time.
  kVehicleStale,      ///< No vehicle status in time.
  kLinkLost,          ///< Device not connected, or nothing heard from it at all.
  kLocalizationLost,  ///< The estimate must not be acted on.
  kVehicleFault,      ///< The vehicle reports a mode that forbids flight.
  kVehicleFlying,     ///< The vehicle says that it flies.
  kAtTarget,          ///< The present take-off or landing target is reached.
  kTouchdown,         ///< On the ground at the end of a landing.
  kMissionLoaded,     ///< A complete, valid mission is in memory.
  kTetherElsewhere,   ///< The loaded mission begins with another contact than the tether now has.
  kMissionDone,       ///< The executor completed it.
  kMissionFailed,     ///< The executor gave up (time-out, no progress, bad contact).
  kOverruns,          ///< The loop has missed several ticks in a row.
  kTimeInMode,        ///< The present mode has lasted longer than it may.
  kLinkFault,         ///< The link is there and something is wrong with it.
};
inline constexpr std::array<EnumName<Condition>, 17> kConditionNames{
    {{Condition::kReelStale, "REEL_STALE"},
     {Condition::kAnglesStale, "ANGLES_STALE"},
     {Condition::kAttitudeStale, "ATTITUDE_STALE"},
     {Condition::kVehicleStale, "VEHICLE_STALE"},
     {Condition::kLinkLost, "LINK_LOST"},
     {Condition::kLocalizationLost, "LOCALIZATION_LOST"},
     {Condition::kVehicleFault, "VEHICLE_FAULT"},
     {Condition::kVehicleFlying, "VEHICLE_FLYING"},
     {Condition::kAtTarget, "AT_TARGET"},
     {Condition::kTouchdown, "TOUCHDOWN"},
     {Condition::kMissionLoaded, "MISSION_LOADED"},
     {Condition::kTetherElsewhere, "TETHER_ELSEWHERE"},
     {Condition::kMissionDone, "MISSION_DONE"},
     {Condition::kMissionFailed, "MISSION_FAILED"},
     {Condition::kOverruns, "OVERRUNS"},
     {Condition::kTimeInMode, "TIME_IN_MODE"},
     {Condition::kLinkFault, "LINK_FAULT"}}};

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
  [[nodiscard]] constexpr std::uint32_t bits() const noexcept { return bits_; }
  [[nodiscard]] static constexpr ConditionSet fromBits(std::uint32_t bits) noexcept {
    ConditionSet s;
    s.bits_ = bits;
    return s;
  }
  friend constexpr bool operator==(ConditionSet a, ConditionSet b) noexcept = default;

 private:
  static constexpr std::uint32_t bit(Condition c) noexcept {
    return 1U << static_cast<unsigned>(c);
  }
  std::uint32_t bits_{0};
};

/// Names of the conditions in `set`, separated by blanks. Not real-time safe: displays only.
[[nodiscard]] std::string describe(ConditionSet set);

/// What an operator may ask for.
enum class Request : std::uint8_t {
  kNone,
  kArm,
  kDisarm,
  kTakeoff,
  kNavigate,
  kHold,
  kLand,
  kStop
};
inline constexpr std::array<EnumName<Request>, 8> kRequestNames{{{Request::kNone, "none"},
                                                                 {Request::kArm, "arm"},
                                                                 {Request::kDisarm, "disarm"},
                                                                 {Request::kTakeoff, "takeoff"},
                                                                 {Request::kNavigate, "navigate"},
                                                                 {Request::kHold, "hold"},
                                                                 {Request::kLand, "land"},
                                                                 {Request::kStop, "stop"}}};

struct SupervisorConfig {
  double takeoff_timeout_s{30.0};
  double armed_timeout_s{120.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("takeoff_timeout_s", takeoff_timeout_s, Range{1, 600},
            "longest time in TAKEOFF before LAND");
    v.field("armed_timeout_s", armed_timeout_s, Range{1, 3600},
            "longest time in ARMED on the ground before STANDBY");
  }
};

struct SupervisorOutput {
  Mode mode{Mode::kStandby};
  bool changed{false};        ///< The mode changed in this step.
  bool request_taken{false};  ///< The request caused or repeated the present mode.
  ConditionSet reasons;  ///< Conditions behind the last change that no one asked for; empty if an
                         ///< operator did.
  ConditionSet
      refusal;  ///< Request refused: conditions in its way; with none, the mode does not allow it.
  Duration time_in_mode{};
};

/// The supervisor. Real-time safe: no allocation, no locks, no exceptions.
class Supervisor {
 public:
  explicit Supervisor(const SupervisorConfig& config) noexcept : config_(config) {}

  /// One cycle. kTimeInMode is set by the supervisor itself, from `now` and its config.
  SupervisorOutput step(Time now, ConditionSet conditions, Request request) noexcept;

  [[nodiscard]] Mode mode() const noexcept { return mode_; }

 private:
  void enter(Mode mode, Time now, ConditionSet reasons) noexcept;
  [[nodiscard]] bool timedOut(Duration time_in_mode) const noexcept;

  SupervisorConfig config_;
  Mode mode_{Mode::kStandby};
  Time entered_{};
  bool started_{false};
  ConditionSet reasons_;
};

/// One row of the transition table, for the code, the documentation and the exhaustive test alike.
struct Transition {
  std::uint16_t from;     ///< Bit i: applies in Mode i.
  Request request;        ///< kNone: happens by itself.
  ConditionSet when_any;  ///< By itself: at least one of these (empty: not needed).
  ConditionSet when_all;  ///< And all of these.
  ConditionSet unless;    ///< And none of these; for a request they are the reason of the refusal.
  Mode to;
};

/// First row that fits wins: automatic rows first, most severe first, then requests.
[[nodiscard]] const Transition* transitionTable(int& count) noexcept;

}  // namespace tautline
