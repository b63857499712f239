#pragma once

/// @file
/// Any LCM message as names and values, by the table of all types. Bytes are taken as they come: a
/// forged or damaged packet is "not decoded", never more. Not real-time safe.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "lcmtypes/message_table.h"

namespace tautline {

/// Values by name, in the order of the .lcm file. Arrays are arrays. JSON has no NaN and no
/// infinity: dump() prints them as null.
using DecodedMessage = nlohmann::ordered_json;

/// First eight bytes of a packet; nullopt if it has not as many.
[[nodiscard]] std::optional<std::int64_t> fingerprintOf(std::span<const std::uint8_t> packet);

/// The type with the packet's fingerprint, or nullptr: unknown, or of another version.
[[nodiscard]] const MessageInfo* findMessage(std::span<const std::uint8_t> packet,
                                             MessageTable table = messageTable());

/// Decodes a packet of type `info`; nullopt if it is not exactly one message of it.
[[nodiscard]] std::optional<DecodedMessage> decode(const MessageInfo& info,
                                                   std::span<const std::uint8_t> packet);

/// A single value of a message, e.g. "position_m[2]".
struct FlatField {
  std::string name;
  std::string value;    ///< As JSON has it; strings without their quotes; nan, inf and -inf.
  const char* comment;  ///< FieldInfo::comment.
};

/// All single values in order. Arrays of fixed length are one field an item; those whose length
/// varies are one field with the whole array, so that every message of a type has as many.
/// Pre-condition: `message` is of type `info`.
[[nodiscard]] std::vector<FlatField> flatten(const MessageInfo& info,
                                             const DecodedMessage& message);

}  // namespace tautline
