#pragma once

/// @file
/// Whether a CAN interface is open, and if not, why: for the station's telemetry and for people.

#include <cstdint>
#include <string>

#include "common/vehicle.h"

namespace tautline {

enum class CanStatus : std::uint8_t {
  kOpen,
  kNoCan,            ///< The kernel has no CAN, or this program may not use it.
  kNoSuchInterface,  ///< Also: was there and has been deleted.
  kNotCan,           ///< An interface of another kind.
  kDown,             ///< There, and switched off.
  kPermission,
  kRealDevice,  ///< Only a virtual interface is allowed, and this is none.
  kSettings,    ///< Filters or time stamps did not read back as set.
  kClosed,      ///< The far end of an adopted socket pair is gone.
  kFailed,      ///< Anything else; errno tells.
};

/// Why there is no link; kNone for kOpen. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] LinkFault faultOf(CanStatus status) noexcept;

/// One line: what is wrong with the interface `name` and the command that mends it; empty for
/// kOpen. `error`: errno of the attempt. Not real-time safe: start-up only.
[[nodiscard]] std::string describe(CanStatus status, int error, const std::string& name);

}  // namespace tautline
