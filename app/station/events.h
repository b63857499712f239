#pragma once

/// @file
/// What the station tells an operator: one table of codes with severity, text, reaction and remedy.

#include <array>
#include <cstdint>

#include "common/vehicle.h"
#include "supervision/supervisor.h"

namespace tautline {

enum class Severity : std::uint8_t { kInfo, kWarning, kError, kCritical };
inline constexpr std::array<EnumName<Severity>, 4> kSeverityNames{
    {{Severity::kInfo, "info"},
     {Severity::kWarning, "warning"},
     {Severity::kError, "error"},
     {Severity::kCritical, "critical"}}};

enum class EventCode : std::uint8_t {
  kModeChanged,
  kMissionCompleted,
  kWaypointTimeout,
  kNoProgress,
  kBadContact,
  kUnreachable,
  kConditionCame,  ///< Text and remedy are those of kConditionInfos.
  kConditionWent,
  kLinkSilent,  ///< This and the following in the order of LinkFault.
  kLinkGarbage,
  kLinkOtherProtocol,
  kLinkUnreliable,
  kLinkSensorRate,
  kLinkAnotherStation,
  kLinkInterfaceMissing,
  kLinkInterfaceDown,
  kLinkBusOff,
  kLinkBusErrors,
  kLinkNoAcknowledge,
  kLinkFaultCleared,
};

/// In event_t.code: twice a condition's number from here on, and one more when it is over.
inline constexpr std::int32_t kFirstConditionCode = 1000;

struct EventText {
  EventCode code;
  Severity severity;
  const char* text;
  const char* reaction;
  const char* remedy;
};

inline constexpr auto kEventTexts = std::to_array<EventText>({
    {EventCode::kModeChanged, Severity::kInfo, "mode ", "", ""},
    {EventCode::kMissionCompleted, Severity::kInfo, "mission completed",
     "hovering at its last waypoint", ""},
    {EventCode::kWaypointTimeout, Severity::kError, "waypoint not reached in time",
     "mission ended, hovering", "check wind, tether and reel; then navigate again or land"},
    {EventCode::kNoProgress, Severity::kError, "no progress towards the waypoint",
     "mission ended, hovering", "look whether the tether is caught; then navigate again or land"},
    {EventCode::kBadContact, Severity::kError,
     "waypoint needs a contact that the mission does not have", "mission ended, hovering",
     "run `tautline mission check` on the file"},
    {EventCode::kUnreachable, Severity::kError, "waypoint is beyond the tether",
     "mission ended, hovering", "run `tautline mission check` on the file"},
    {EventCode::kConditionCame, Severity::kError, "", "", ""},
    {EventCode::kConditionWent, Severity::kInfo, "over: ", "", ""},
    {EventCode::kLinkSilent, Severity::kError, "the device is connected and says nothing",
     "no arming",
     "check its power and wiring, and that serial.baud and the bus's bit rate are its own"},
    {EventCode::kLinkGarbage, Severity::kError, "what the device sends means nothing", "no arming",
     "set serial.baud to the device's own rate; then check cable and ground"},
    {EventCode::kLinkOtherProtocol, Severity::kError,
     "the device speaks another protocol than the configured one", "no arming",
     "set device to what is plugged in (fotokite, tautline-can, tautline-serial), or plug in the "
     "other one"},
    {EventCode::kLinkUnreliable, Severity::kError,
     "half of the device's messages or more fail their check", "no arming",
     "look for two devices with one identifier, then check cable, ground and termination"},
    {EventCode::kLinkSensorRate, Severity::kError, "a sensor sends at another rate than agreed",
     "no arming", "set reel, angle sensor and vehicle to one message every 10 ms"},
    {EventCode::kLinkAnotherStation, Severity::kCritical, "another station commands on this bus",
     "no arming", "stop the other tautline-station, or take it off the bus"},
    {EventCode::kLinkInterfaceMissing, Severity::kError, "the CAN interface is not there",
     "no arming; trying again",
     "plug the adapter in; see `ip -brief link show type can`, and can.interface"},
    {EventCode::kLinkInterfaceDown, Severity::kError, "the CAN interface is down",
     "no arming; trying again",
     "as root: ip link set can0 up type can bitrate 500000 restart-ms 100"},
    {EventCode::kLinkBusOff, Severity::kError, "the CAN controller is off the bus", "no arming",
     "check wiring and bit rate; as root: ip link set can0 down; ip link set can0 up type can "
     "bitrate 500000 restart-ms 100"},
    {EventCode::kLinkBusErrors, Severity::kError, "the CAN controller sees errors on the bus",
     "no arming", "check the bit rate (500000), wiring, and 120 ohm at both ends"},
    {EventCode::kLinkNoAcknowledge, Severity::kError, "nobody on the bus acknowledges", "no arming",
     "switch the devices on; then check wiring, bit rate and termination"},
    {EventCode::kLinkFaultCleared, Severity::kInfo, "the link is in order again", "", ""},
});

/// Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] constexpr const EventText& textOf(EventCode code) noexcept {
  return kEventTexts[static_cast<std::size_t>(code)];
}

/// The event of a link's fault. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] constexpr EventCode eventOf(LinkFault fault) noexcept {
  if (fault == LinkFault::kNone) return EventCode::kLinkFaultCleared;
  return static_cast<EventCode>(static_cast<std::size_t>(EventCode::kLinkSilent) +
                                static_cast<std::size_t>(fault) - 1);
}
static_assert(eventOf(LinkFault::kSilent) == EventCode::kLinkSilent &&
              eventOf(LinkFault::kNoAcknowledge) == EventCode::kLinkNoAcknowledge);

static_assert(
    [] {
      for (std::size_t i = 0; i < kEventTexts.size(); ++i) {
        if (static_cast<std::size_t>(kEventTexts[i].code) != i) return false;
      }
      return true;
    }(),
    "kEventTexts must be in the order of EventCode");

/// One event of a cycle.
struct StationEvent {
  EventCode code{EventCode::kModeChanged};
  Mode mode{Mode::kStandby};  ///< kModeChanged only.
  ConditionSet reasons{};     ///< kModeChanged only.
  Condition condition{};      ///< This and what follows: kConditionCame, kConditionWent only.
  double value{0.0};
  double limit{0.0};
};

}  // namespace tautline
