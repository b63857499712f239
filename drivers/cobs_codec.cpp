#include "drivers/cobs_codec.h"

#include <algorithm>
#include <boost/crc.hpp>

namespace tautline::bus {
namespace {

using Crc16 = boost::crc_optimal<16, kCrc16Polynomial, kCrc16Initial, 0, false, false>;

constexpr std::size_t kMaxPlain = kMaxCobs - 1;

std::uint16_t crc16(std::span<const std::uint8_t> bytes) noexcept {
  Crc16 crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

}  // namespace

SerialFrame encodeSerial(const BusFrame& frame) noexcept {
  std::array<std::uint8_t, kMaxPlain> plain{};
  plain[0] = static_cast<std::uint8_t>(frame.id & 0xFFU);
  plain[1] = static_cast<std::uint8_t>(frame.id >> 8U);
  plain[2] = frame.size;
  std::copy_n(frame.data.begin(), frame.size, plain.begin() + kSerialHeader);
  std::size_t size = kSerialHeader + frame.size;
  const std::uint16_t crc = crc16(std::span(plain.data(), size));
  plain[size++] = static_cast<std::uint8_t>(crc & 0xFFU);
  plain[size++] = static_cast<std::uint8_t>(crc >> 8U);

  SerialFrame out;
  std::size_t code_at = 0;  // where the distance to the next zero byte is written
  out.size = 1;
  for (std::size_t i = 0; i < size; ++i) {
    if (plain[i] != 0) {
      out.buffer[out.size++] = plain[i];
      continue;
    }
    out.buffer[code_at] = static_cast<std::uint8_t>(out.size - code_at);
    code_at = out.size++;
  }
  out.buffer[code_at] = static_cast<std::uint8_t>(out.size - code_at);
  out.buffer[out.size++] = 0;
  return out;
}

DecodedSerial decodeSerial(std::span<const std::uint8_t> cobs) noexcept {
  DecodedSerial out;
  std::array<std::uint8_t, kMaxPlain> plain{};
  std::size_t size = 0;
  for (std::size_t i = 0; i < cobs.size();) {
    const std::size_t code = cobs[i];
    if (code == 0 || i + code > cobs.size()) {
      out.error = FramingError::kCobs;
      return out;
    }
    const bool last = i + code == cobs.size();
    if (size + code - (last ? 1 : 0) > plain.size()) {
      out.error = FramingError::kTooLong;
      return out;
    }
    std::copy_n(cobs.begin() + static_cast<std::ptrdiff_t>(i) + 1, code - 1,
                plain.begin() + static_cast<std::ptrdiff_t>(size));
    size += code - 1;
    if (!last) plain[size++] = 0;
    i += code;
  }
  if (size < kSerialHeader + kSerialCrc || plain[2] > kMaxData ||
      size != kSerialHeader + plain[2] + kSerialCrc) {
    out.error = FramingError::kLength;
    return out;
  }
  const std::size_t covered = size - kSerialCrc;
  const unsigned sent = plain[covered] | static_cast<unsigned>(plain[covered + 1] << 8U);
  if (crc16(std::span(plain.data(), covered)) != sent) {
    out.error = FramingError::kCrc;
    return out;
  }
  out.frame.id = static_cast<std::uint16_t>(plain[0] | static_cast<unsigned>(plain[1] << 8U));
  out.frame.size = plain[2];
  std::copy_n(plain.begin() + kSerialHeader, plain[2], out.frame.data.begin());
  return out;
}

}  // namespace tautline::bus
