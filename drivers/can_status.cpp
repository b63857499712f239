#include "drivers/can_status.h"

#include <system_error>

namespace tautline {

std::string describe(CanStatus status, int error, const std::string& name) {
  const std::string bring_up = "ip link set " + name + " up type can bitrate 500000 restart-ms 100";
  switch (status) {
    case CanStatus::kOpen:
      return {};
    case CanStatus::kNoCan:
      return name +
             ": this kernel has no CAN, or the program may not use it; as root: modprobe can-raw "
             "(in a systemd unit: RestrictAddressFamilies must have AF_CAN)";
    case CanStatus::kNoSuchInterface:
      return name +
             ": no such interface; plug the adapter in or set can.interface (ip -brief link show "
             "type can), then as root: " +
             bring_up;
    case CanStatus::kNotCan:
      return name + ": is no CAN interface; set can.interface (ip -brief link show type can)";
    case CanStatus::kDown:
      return name + ": is down; as root: " + bring_up + " (vcan: ip link set " + name + " up)";
    case CanStatus::kPermission:
      return name + ": permission denied; run it as a user who may open CAN sockets";
    case CanStatus::kRealDevice:
      return name +
             ": is a real bus, and only a virtual one is allowed; set run_mode = \"REAL\" to use "
             "it";
    case CanStatus::kSettings:
      return name + ": filters or time stamps did not take; update the kernel";
    case CanStatus::kClosed:
      return name + ": the other end is gone; start it again";
    case CanStatus::kFailed:
      break;
  }
  return name + ": cannot open: " + std::generic_category().message(error) + "; see `ip -details " +
         "link show " + name + "`";
}

LinkFault faultOf(CanStatus status) noexcept {
  switch (status) {
    case CanStatus::kOpen:
      return LinkFault::kNone;
    case CanStatus::kNoCan:
      return LinkFault::kNoCan;
    case CanStatus::kNoSuchInterface:
    case CanStatus::kClosed:
      return LinkFault::kInterfaceMissing;
    case CanStatus::kNotCan:
      return LinkFault::kNotCan;
    case CanStatus::kDown:
      return LinkFault::kInterfaceDown;
    case CanStatus::kPermission:
      return LinkFault::kCanPermission;
    case CanStatus::kRealDevice:
      return LinkFault::kRealDevice;
    case CanStatus::kSettings:
      return LinkFault::kCanSettings;
    case CanStatus::kFailed:
      break;
  }
  return LinkFault::kPortFailed;
}

}  // namespace tautline
