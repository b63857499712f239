#pragma once

/// @file
/// What the station tells an operator: one table of codes with severity, text, reaction and remedy.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

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
  kLinkPortMissing,
  kLinkPortBusy,
  kLinkPortPermission,
  kLinkPortSettings,
  kLinkNotSerial,
  kLinkRealDevice,
  kLinkNotCan,
  kLinkNoCan,
  kLinkCanPermission,
  kLinkCanSettings,
  kLinkPortFailed,
  kLinkFaultCleared,
  kOperatorAccepted,  ///< This and the following are the audit of operators.
  kOperatorRefused,
  kLeaseChanged,
  kParameterChanged,
};

/// In event_t.code: twice a condition's number from here on, and one more when it is over.
inline constexpr std::int32_t kFirstConditionCode = 1000;

/// In text and remedy {} stands for the serial device or CAN interface; appendText() puts it in.
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
    {EventCode::kLinkInterfaceMissing, Severity::kError, "the CAN interface {} is not there",
     "no arming; trying again",
     "plug the adapter in; see `ip -brief link show type can`, and can.interface"},
    {EventCode::kLinkInterfaceDown, Severity::kError, "the CAN interface {} is down",
     "no arming; trying again",
     "as root: ip link set {} up type can bitrate 500000 restart-ms 100"},
    {EventCode::kLinkBusOff, Severity::kError, "the CAN controller is off the bus", "no arming",
     "check wiring and bit rate; as root: ip link set {} down; ip link set {} up type can "
     "bitrate 500000 restart-ms 100"},
    {EventCode::kLinkBusErrors, Severity::kError, "the CAN controller sees errors on the bus",
     "no arming", "check the bit rate (500000), wiring, and 120 ohm at both ends"},
    {EventCode::kLinkNoAcknowledge, Severity::kError, "nobody on the bus acknowledges", "no arming",
     "switch the devices on; then check wiring, bit rate and termination"},
    {EventCode::kLinkPortMissing, Severity::kError, "the device {} is not there",
     "no arming; trying again",
     "plug it in and switch it on; see `ls -l /dev/serial/by-id`, and serial.device"},
    {EventCode::kLinkPortBusy, Severity::kError, "another program has {}",
     "no arming; trying again", "end that program; as root: fuser -v {}"},
    {EventCode::kLinkPortPermission, Severity::kError, "the station may not use {}",
     "no arming; trying again",
     "as root: usermod -aG \"$(stat -Lc %G {})\" USER; then log in and start the station again"},
    {EventCode::kLinkPortSettings, Severity::kError, "{} does not take 8N1 at serial.baud",
     "no arming; trying again", "set serial.baud to a rate that the adapter offers"},
    {EventCode::kLinkNotSerial, Severity::kError, "{} is no serial device",
     "no arming; trying again", "set serial.device to one of `ls /dev/serial/by-id`"},
    {EventCode::kLinkRealDevice, Severity::kCritical,
     "{} is real, and run_mode allows only an emulated one", "not opened; trying again",
     "unplug it, or set run_mode = \"REAL\" to use it"},
    {EventCode::kLinkNotCan, Severity::kError, "{} is no CAN interface", "no arming; trying again",
     "set can.interface to one of `ip -brief link show type can`"},
    {EventCode::kLinkNoCan, Severity::kError, "this kernel has no CAN, or hides it",
     "no arming; trying again",
     "as root: modprobe can-raw; in a systemd unit RestrictAddressFamilies must have AF_CAN"},
    {EventCode::kLinkCanPermission, Severity::kError, "the station may not open CAN sockets",
     "no arming; trying again", "run it outside of the sandbox that forbids them"},
    {EventCode::kLinkCanSettings, Severity::kError, "filters or time stamps of {} do not take",
     "no arming; trying again", "update the kernel"},
    {EventCode::kLinkPortFailed, Severity::kError, "{} cannot be opened", "no arming; trying again",
     "check cable and name; `dmesg | tail` may say more"},
    {EventCode::kLinkFaultCleared, Severity::kInfo, "the link is in order again", "", ""},
    {EventCode::kOperatorAccepted, Severity::kInfo, "", "", ""},
    {EventCode::kOperatorRefused, Severity::kWarning, "", "", ""},
    {EventCode::kLeaseChanged, Severity::kInfo, "lease ", "", ""},
    {EventCode::kParameterChanged, Severity::kInfo, "", "", ""},
});

/// Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] constexpr const EventText& textOf(EventCode code) noexcept {
  return kEventTexts[static_cast<std::size_t>(code)];
}

/// Appends a text of the table. `place`: the serial device or CAN interface. Real-time safe while
/// `out` has the capacity.
inline void appendText(std::string& out, std::string_view text, std::string_view place) {
  for (std::size_t hole = text.find("{}"); hole != text.npos; hole = text.find("{}")) {
    out.append(text.substr(0, hole)).append(place);
    text.remove_prefix(hole + 2);
  }
  out.append(text);
}

/// The event of a link's fault. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] constexpr EventCode eventOf(LinkFault fault) noexcept {
  if (fault == LinkFault::kNone) return EventCode::kLinkFaultCleared;
  return static_cast<EventCode>(static_cast<std::size_t>(EventCode::kLinkSilent) +
                                static_cast<std::size_t>(fault) - 1);
}
static_assert(eventOf(LinkFault::kSilent) == EventCode::kLinkSilent &&
              eventOf(LinkFault::kPortFailed) == EventCode::kLinkPortFailed);

/// Who did what; told apart from what happens to the drone.
[[nodiscard]] constexpr bool isAudit(EventCode code) noexcept {
  return code >= EventCode::kOperatorAccepted;
}

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
