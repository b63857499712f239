#pragma once

/// @file
/// What the flags and flight modes of each vehicle mean to the supervisor: one table for each
/// protocol. Names are the protocol's own (drivers/*_protocol.h).

#include <cstdint>
#include <optional>
#include <span>

#include "common/vehicle.h"
#include "supervision/condition.h"

namespace tautline {

/// One flag bit or one flight mode.
struct VehicleSign {
  std::uint16_t code;  ///< Bit mask of a flag, number of a mode.
  const char* name;
  std::optional<Condition> condition;  ///< What it raises; empty: nothing.
  const char* text;
  const char* remedy;
};

/// Rows of a protocol; none for an unknown one. Real-time safe: no allocation, no locks, no
/// exceptions.
[[nodiscard]] std::span<const VehicleSign> flagsOf(VehicleProtocol protocol) noexcept;
[[nodiscard]] std::span<const VehicleSign> modesOf(VehicleProtocol protocol) noexcept;

/// Calls `visit` with every row that `reading` shows: its flight mode, then each flag that is set.
template <class Visit>
void forEachSign(const VehicleReading& reading, const Visit& visit) {
  for (const VehicleSign& mode : modesOf(reading.protocol))
    if (mode.code == reading.flight_mode) visit(mode);
  for (const VehicleSign& flag : flagsOf(reading.protocol))
    if ((reading.flags & flag.code) != 0) visit(flag);
}

/// All conditions that `reading` raises. A vehicle of an unknown protocol is judged by its phase, a
/// mode that is not in its table is a warning. Real-time safe: no allocation, no locks, no
/// exceptions.
[[nodiscard]] ConditionSet conditionsOf(const VehicleReading& reading) noexcept;

}  // namespace tautline
