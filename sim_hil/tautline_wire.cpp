#include "sim_hil/tautline_wire.h"

#include <linux/can.h>

#include <algorithm>
#include <cstring>
#include <string_view>

namespace tautline::sim {
namespace {

unsigned crc16(std::span<const std::uint8_t> bytes) noexcept {
  unsigned crc = bus::kCrc16Initial;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<unsigned>(byte) << 8U;
    for (int bit = 0; bit < 8; ++bit)
      crc = ((crc & 0x8000U) != 0 ? (crc << 1U) ^ bus::kCrc16Polynomial : crc << 1U) & 0xFFFFU;
  }
  return crc;
}

WireBytes cobsOf(const TautlineFrame& frame) noexcept {
  WireBytes plain;
  plain.put(frame.id & 0xFFU);
  plain.put(frame.id >> 8U);
  plain.put(frame.size);
  for (std::size_t i = 0; i < frame.size; ++i) plain.put(frame.data[i]);
  const unsigned crc = crc16(plain.bytes());
  plain.put(crc & 0xFFU);
  plain.put(crc >> 8U);
  WireBytes out;
  // Block by block: its length plus one, then its bytes without the zero that ended it.
  std::span<const std::uint8_t> rest = plain.bytes();
  for (;;) {
    const auto zero = std::find(rest.begin(), rest.end(), 0);
    const auto length = static_cast<std::size_t>(zero - rest.begin());
    out.put(static_cast<unsigned>(length + 1));
    for (std::size_t i = 0; i < length; ++i) out.put(rest[i]);
    if (zero == rest.end()) break;
    rest = rest.subspan(length + 1);
  }
  out.put(0);
  return out;
}

WireBytes slcanOf(const TautlineFrame& frame) noexcept {
  static constexpr std::string_view kDigits = "0123456789ABCDEF";
  WireBytes out;
  const auto hex = [&out](unsigned value, unsigned digits) {
    while (digits-- > 0) out.put(static_cast<unsigned char>(kDigits[value >> (4 * digits) & 0xFU]));
  };
  out.put('t');
  hex(frame.id, 3);
  hex(frame.size, 1);
  for (std::size_t i = 0; i < frame.size; ++i) hex(frame.data[i], 2);
  out.put('\r');
  return out;
}

WireBytes recordOf(const TautlineFrame& frame) noexcept {
  can_frame record{};
  record.can_id = frame.id;
  record.can_dlc = frame.size;
  std::copy_n(frame.data.begin(), frame.size, std::begin(record.data));
  WireBytes out;
  std::memcpy(out.buffer.data(), &record, sizeof(record));
  out.size = sizeof(record);
  return out;
}

int digitOf(std::uint8_t c) noexcept {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

}  // namespace

WireBytes encodeFrame(Wire wire, const TautlineFrame& frame) noexcept {
  switch (wire) {
    case Wire::kCobs:
      return cobsOf(frame);
    case Wire::kSlcan:
      return slcanOf(frame);
    case Wire::kCanFrame:
      break;
  }
  return recordOf(frame);
}

bool WireParser::take(std::uint8_t byte, TautlineFrame& frame, WireBytes& reply) noexcept {
  const bool ends = (wire_ == Wire::kCobs && byte == 0) || (wire_ == Wire::kSlcan && byte == '\r');
  if (!ends) {
    if (size_ < piece_.size()) piece_[size_] = byte;
    size_ = std::min(size_ + 1, piece_.size() + 1);
    if (wire_ != Wire::kCanFrame || size_ < sizeof(can_frame)) return false;
  }
  const bool whole = size_ <= piece_.size();
  bool got = false;
  if (whole && size_ > 0) {
    got = wire_ == Wire::kCobs    ? takeCobs(frame)
          : wire_ == Wire::kSlcan ? takeSlcan(frame, reply)
                                  : takeRecord(frame);
  }
  bad_ += size_ > 0 && !got && reply.size == 0 ? 1U : 0U;
  size_ = 0;
  return got;
}

bool WireParser::takeCobs(TautlineFrame& frame) noexcept {
  std::array<std::uint8_t, 40> plain{};
  std::size_t count = 0;
  std::size_t next_code = 0;
  for (std::size_t i = 0; i < size_; ++i) {
    if (i != next_code) {
      plain[count++] = piece_[i];
      continue;
    }
    if (i > 0) plain[count++] = 0;
    next_code = i + piece_[i];
  }
  if (next_code != size_ || count < 5 || plain[2] > frame.data.size() || count != 5U + plain[2])
    return false;
  const unsigned sent = plain[count - 2] | static_cast<unsigned>(plain[count - 1] << 8U);
  if (crc16(std::span(plain.data(), count - 2)) != sent) return false;
  frame.id = static_cast<std::uint16_t>(plain[0] | plain[1] << 8U);
  frame.size = plain[2];
  std::copy_n(plain.begin() + 3, frame.size, frame.data.begin());
  return true;
}

/// "tIIILDD…": a message; everything else (open, close, bit rate, version) is answered and ignored.
bool WireParser::takeSlcan(TautlineFrame& frame, WireBytes& reply) noexcept {
  if (piece_[0] != 't') {
    if (piece_[0] == 'V' || piece_[0] == 'N') {
      for (const char c : std::string_view(piece_[0] == 'V' ? "V1013" : "N0001"))
        reply.put(static_cast<unsigned char>(c));
    }
    reply.put('\r');
    return false;
  }
  std::array<int, 40> digit{};
  std::transform(piece_.begin(), piece_.begin() + static_cast<std::ptrdiff_t>(size_), digit.begin(),
                 digitOf);
  if (size_ < 5 ||
      std::any_of(digit.begin() + 1, digit.begin() + static_cast<std::ptrdiff_t>(size_),
                  [](int d) { return d < 0; }))
    return false;
  const auto at = [&digit](std::size_t i) { return static_cast<unsigned>(digit[i]); };
  if (at(1) > 7 || at(4) > 8 || size_ != 5 + 2 * at(4)) return false;
  frame.id = static_cast<std::uint16_t>(at(1) << 8U | at(2) << 4U | at(3));
  frame.size = static_cast<std::uint8_t>(at(4));
  for (std::size_t i = 0; i < frame.size; ++i)
    frame.data[i] = static_cast<std::uint8_t>(at(5 + 2 * i) << 4U | at(6 + 2 * i));
  return true;
}

bool WireParser::takeRecord(TautlineFrame& frame) noexcept {
  can_frame record{};
  std::memcpy(&record, piece_.data(), sizeof(record));
  if (record.can_id > CAN_SFF_MASK || record.can_dlc > frame.data.size()) return false;
  frame.id = static_cast<std::uint16_t>(record.can_id);
  frame.size = record.can_dlc;
  std::copy_n(std::begin(record.data), frame.size, frame.data.begin());
  return true;
}

}  // namespace tautline::sim
