#pragma once

/// @file
/// Decides what the station may do: modes, condition bits and one ordered table of transitions
/// (docs/supervisor.md). A pure function of conditions, request and time; it knows nothing of
/// sensors or controllers.

#include <array>
#include <cstdint>
#include <initializer_list>

#include "common/fields.h"
#include "common/time.h"
#include "supervision/condition.h"

namespace tautline {

/// A mode is a rung of what the station may do; flying modes stand in the order of their severity
/// where the station chooses them by itself (kFailsafe … kEstop).
enum class Mode : std::uint8_t {
  kStandby,   ///< Disarmed. Every start comes up here.
  kArmed,     ///< Ready to take off, motors off.
  kTakeoff,   ///< Motors on, climbing to the hover point above home.
  kHold,      ///< Hovering where it was when the mode began.
  kTeleop,    ///< Following the sticks of the operator who holds the lease.
  kAuto,      ///< Flying the mission.
  kFailsafe,  ///< Hovering, deaf to sticks and mission until the operator chooses another mode.
  kBackUp,    ///< Going back along the flown path for a while, contacts undone in reverse order.
  kReturn,    ///< The same, all the way home.
  kLand,      ///< Going home, descending, stopping the motors.
  kDescend,   ///< Going down where it is, without asking the tether where that is.
  kEstop,     ///< Motors and reel off, latched until disarmed by the operator.
};
inline constexpr std::array<EnumName<Mode>, 12> kModeNames{{{Mode::kStandby, "STANDBY"},
                                                            {Mode::kArmed, "ARMED"},
                                                            {Mode::kTakeoff, "TAKEOFF"},
                                                            {Mode::kHold, "HOLD"},
                                                            {Mode::kTeleop, "TELEOP"},
                                                            {Mode::kAuto, "AUTO"},
                                                            {Mode::kFailsafe, "FAILSAFE"},
                                                            {Mode::kBackUp, "BACKUP"},
                                                            {Mode::kReturn, "RETURN"},
                                                            {Mode::kLand, "LAND"},
                                                            {Mode::kDescend, "DESCEND"},
                                                            {Mode::kEstop, "ESTOP"}}};

/// A set of modes, one bit each.
using ModeMask = std::uint16_t;
[[nodiscard]] constexpr ModeMask maskOf(std::initializer_list<Mode> modes) noexcept {
  ModeMask mask = 0;
  for (const Mode m : modes) mask = static_cast<ModeMask>(mask | (1U << static_cast<unsigned>(m)));
  return mask;
}
[[nodiscard]] constexpr bool isIn(Mode mode, ModeMask mask) noexcept {
  return (mask & maskOf({mode})) != 0;
}
inline constexpr ModeMask kEveryMode = 0xFFFF;
/// Motors on, or about to be.
inline constexpr ModeMask kFlyingModes =
    maskOf({Mode::kTakeoff, Mode::kHold, Mode::kTeleop, Mode::kAuto, Mode::kFailsafe, Mode::kBackUp,
            Mode::kReturn, Mode::kLand, Mode::kDescend});

/// What an operator may ask for.
enum class Request : std::uint8_t {
  kNone,
  kArm,
  kDisarm,
  kTakeoff,
  kNavigate,
  kHold,
  kTeleop,
  kBackUp,
  kReturn,
  kLand,
  kStop,   ///< Stand still now, deaf to everything but the next request.
  kEstop,  ///< Motors off.
};
inline constexpr std::array<EnumName<Request>, 12> kRequestNames{{{Request::kNone, "none"},
                                                                  {Request::kArm, "arm"},
                                                                  {Request::kDisarm, "disarm"},
                                                                  {Request::kTakeoff, "takeoff"},
                                                                  {Request::kNavigate, "navigate"},
                                                                  {Request::kHold, "hold"},
                                                                  {Request::kTeleop, "teleop"},
                                                                  {Request::kBackUp, "backup"},
                                                                  {Request::kReturn, "return"},
                                                                  {Request::kLand, "land"},
                                                                  {Request::kStop, "stop"},
                                                                  {Request::kEstop, "estop"}}};

struct SupervisorConfig {
  double takeoff_timeout_s{30.0};
  double armed_timeout_s{120.0};
  double failsafe_timeout_s{10.0};
  double land_timeout_s{120.0};
  template <class Visitor>
  void fields(Visitor& v) {
    v.field("takeoff_timeout_s", takeoff_timeout_s, Range{1, 600},
            "longest time in TAKEOFF before LAND");
    v.field("armed_timeout_s", armed_timeout_s, Range{1, 3600},
            "longest time in ARMED on the ground before STANDBY");
    v.field("failsafe_timeout_s", failsafe_timeout_s, Range{1, 600},
            "time in FAILSAFE before the second stage: RETURN, LAND or DESCEND by its cause");
    v.field("land_timeout_s", land_timeout_s, Range{10, 3600},
            "a landing without a position ends in DESCEND after this long");
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
  ModeMask from;
  Request request;        ///< kNone: happens by itself.
  ConditionSet when_any;  ///< By itself: at least one of these (empty: not needed).
  ConditionSet when_all;  ///< And all of these.
  ConditionSet unless;    ///< And none of these; for a request they are the reason of the refusal.
  Mode to;
};

/// The rows that happen by themselves, most severe first, then those on request. In each part the
/// first that fits wins. A request is judged from where the first part has led; one that starts
/// something is refused in a cycle in which the mode has changed by itself.
[[nodiscard]] const Transition* transitionTable(int& count) noexcept;

}  // namespace tautline
