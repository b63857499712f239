#include "app/log/message_decoder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace tautline {
namespace {

constexpr int kMaxDepth = 16;  // of messages in messages; LCM's types may contain themselves

/// Reads big-endian values off the front; once something does not fit, `good` stays false.
class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  template <class Unsigned>
  Unsigned take() {
    if (rest_.size() < sizeof(Unsigned)) return fail<Unsigned>();
    std::uint64_t value = 0;
    for (const std::uint8_t byte : rest_.first(sizeof(Unsigned))) value = value << 8 | byte;
    rest_ = rest_.subspan(sizeof(Unsigned));
    return static_cast<Unsigned>(value);
  }

  std::string takeString() {
    const auto size = take<std::uint32_t>();  // with the final 0
    if (!good_ || size < 1 || size > rest_.size() || rest_[size - 1] != 0)
      return fail<std::string>();
    std::string text(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(size) - 1);
    rest_ = rest_.subspan(size);
    return text;
  }

  template <class Result>
  Result fail() {
    good_ = false;
    return {};
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] std::size_t left() const { return rest_.size(); }

 private:
  std::span<const std::uint8_t> rest_;
  bool good_{true};
};

DecodedMessage takeMessage(const MessageInfo& info, Cursor& in, int depth);

DecodedMessage takeValue(const FieldInfo& field, Cursor& in, int depth) {
  switch (field.type) {
    case FieldType::kInt8:
      return static_cast<std::int8_t>(in.take<std::uint8_t>());
    case FieldType::kByte:
      return in.take<std::uint8_t>();
    case FieldType::kBoolean:
      return in.take<std::uint8_t>() != 0;
    case FieldType::kInt16:
      return static_cast<std::int16_t>(in.take<std::uint16_t>());
    case FieldType::kInt32:
      return static_cast<std::int32_t>(in.take<std::uint32_t>());
    case FieldType::kInt64:
      return static_cast<std::int64_t>(in.take<std::uint64_t>());
    case FieldType::kFloat:
      return std::bit_cast<float>(in.take<std::uint32_t>());
    case FieldType::kDouble:
      return std::bit_cast<double>(in.take<std::uint64_t>());
    case FieldType::kString:
      return in.takeString();
    case FieldType::kMessage:
      return takeMessage(*field.message, in, depth + 1);
  }
  return in.fail<DecodedMessage>();
}

/// Array over the dimensions from `level` on; a value behind the last one. `lengths` are theirs.
DecodedMessage takeArray(const FieldInfo& field, std::span<const std::int64_t> lengths, Cursor& in,
                         int depth) {
  if (lengths.empty()) return takeValue(field, in, depth);
  DecodedMessage array = DecodedMessage::array();
  // An item takes a byte at least, or (an empty message) nothing: both end this loop early.
  for (std::int64_t i = 0; i < lengths.front() && in.good(); ++i) {
    if (in.left() == 0) return in.fail<DecodedMessage>();
    array.push_back(takeArray(field, lengths.subspan(1), in, depth));
  }
  return array;
}

DecodedMessage takeMessage(const MessageInfo& info, Cursor& in, int depth) {
  if (depth > kMaxDepth) return in.fail<DecodedMessage>();
  DecodedMessage out = DecodedMessage::object();
  for (const FieldInfo& field : info.fields) {
    std::vector<std::int64_t> lengths;
    for (const FieldDimension& dimension : field.dimensions) {
      lengths.push_back(dimension.counter < 0
                            ? dimension.size
                            : out[info.fields[static_cast<std::size_t>(dimension.counter)].name]
                                  .get<std::int64_t>());
    }
    if (std::any_of(lengths.begin(), lengths.end(), [](std::int64_t n) { return n < 0; }))
      return in.fail<DecodedMessage>();
    out[field.name] = takeArray(field, lengths, in, depth);
    if (!in.good()) return {};
  }
  return out;
}

std::string textOf(const DecodedMessage& value) {
  if (value.is_number_float() && !std::isfinite(value.get<double>()))
    return std::isnan(value.get<double>()) ? "nan" : value.get<double>() > 0.0 ? "inf" : "-inf";
  // Bytes that are no UTF-8 must not end a program that shows them.
  return value.is_string() ? value.get<std::string>()
                           : value.dump(-1, ' ', false, DecodedMessage::error_handler_t::replace);
}

void flattenMessage(const MessageInfo& info, const DecodedMessage& message,
                    const std::string& prefix, std::vector<FlatField>& out);

void flattenField(const FieldInfo& field, std::span<const FieldDimension> dimensions,
                  const DecodedMessage& value, const std::string& name,
                  std::vector<FlatField>& out) {
  if (!dimensions.empty() && dimensions.front().counter < 0) {
    for (std::size_t i = 0; i < value.size(); ++i)
      flattenField(field, dimensions.subspan(1), value[i], name + '[' + std::to_string(i) + ']',
                   out);
  } else if (dimensions.empty() && field.type == FieldType::kMessage) {
    flattenMessage(*field.message, value, name + '.', out);
  } else {
    out.push_back({name, textOf(value), field.comment});
  }
}

void flattenMessage(const MessageInfo& info, const DecodedMessage& message,
                    const std::string& prefix, std::vector<FlatField>& out) {
  for (const FieldInfo& field : info.fields)
    flattenField(field, field.dimensions, message.at(field.name), prefix + field.name, out);
}

}  // namespace

std::optional<std::int64_t> fingerprintOf(std::span<const std::uint8_t> packet) {
  Cursor in(packet);
  const auto value = static_cast<std::int64_t>(in.take<std::uint64_t>());
  return in.good() ? std::optional(value) : std::nullopt;
}

const MessageInfo* findMessage(std::span<const std::uint8_t> packet, MessageTable table) {
  const auto fingerprint = fingerprintOf(packet);
  const auto found = std::find_if(table.begin(), table.end(), [&](const MessageInfo* info) {
    return info->fingerprint == fingerprint;
  });
  return found == table.end() ? nullptr : *found;
}

std::optional<DecodedMessage> decode(const MessageInfo& info,
                                     std::span<const std::uint8_t> packet) {
  if (fingerprintOf(packet) != info.fingerprint) return std::nullopt;
  Cursor in(packet.subspan(sizeof(info.fingerprint)));
  DecodedMessage message = takeMessage(info, in, 0);
  if (!in.good() || in.left() != 0) return std::nullopt;
  return message;
}

std::vector<FlatField> flatten(const MessageInfo& info, const DecodedMessage& message) {
  std::vector<FlatField> out;
  flattenMessage(info, message, "", out);
  return out;
}

}  // namespace tautline
