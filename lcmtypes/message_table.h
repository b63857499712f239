#pragma once

/// @file
/// What the fields of LCM messages are called and how they lie in a packet. The C++ types of
/// lcm-gen know none of this at run time; `toolchain/lcm_message_table.py` writes a table of all
/// types next to them, from the same .lcm files. Not real-time safe.

#include <cstdint>
#include <span>

namespace tautline {

enum class FieldType : std::uint8_t {
  kInt8,
  kInt16,
  kInt32,
  kInt64,
  kByte,
  kFloat,
  kDouble,
  kBoolean,
  kString,
  kMessage,  ///< Another message, FieldInfo::message.
};

struct MessageInfo;

/// One dimension of an array.
struct FieldDimension {
  int size;     ///< Fixed length; 0 if the length is in another field.
  int counter;  ///< Index of that field among the message's, in front of this one; -1 if fixed.
};

struct FieldInfo {
  const char* name;
  FieldType type;
  const MessageInfo* message;                  ///< Of kMessage, else nullptr.
  std::span<const FieldDimension> dimensions;  ///< Outermost first; empty: a single value.
  const char* comment;                         ///< Unit or meaning, as the .lcm file says it.
};

struct MessageInfo {
  const char* name;          ///< With its package: "tautline.estimate_t".
  std::int64_t fingerprint;  ///< First eight bytes of every packet of this type.
  std::span<const FieldInfo> fields;
};

/// All types of one set of .lcm files.
using MessageTable = std::span<const MessageInfo* const>;

/// Those of this folder.
[[nodiscard]] MessageTable messageTable();

}  // namespace tautline
