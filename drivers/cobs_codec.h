#pragma once

/// @file
/// Bus frames on a serial line: identifier, length, data, CRC-16 CCITT-FALSE, made free of zero
/// bytes by COBS (consistent overhead byte stuffing) and ended by one zero byte. Pure, no I/O.
///
/// Everything here: real-time safe: no allocation, no locks, no exceptions.

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>

#include "drivers/bus_frame.h"
#include "drivers/tautline_protocol.h"

namespace tautline::bus {

/// The longest frame between two zero bytes: COBS adds one byte to what is shorter than 254.
inline constexpr std::size_t kMaxCobs = kSerialHeader + kMaxData + kSerialCrc + 1;

enum class FramingError : std::uint8_t {
  kNone,
  kTooLong,  ///< No zero byte within kMaxCobs bytes.
  kCobs,     ///< A COBS code points beyond the frame.
  kLength,   ///< Fewer or more bytes than the length says.
  kCrc,
};
inline constexpr std::size_t kFramingErrorCount = 5;

/// How many frames of each outcome; [kNone] counts the whole ones.
struct FramingCounters {
  std::array<std::uint32_t, kFramingErrorCount> of{};

  void count(FramingError error) noexcept { ++of[static_cast<std::size_t>(error)]; }
  [[nodiscard]] std::uint32_t operator[](FramingError error) const noexcept {
    return of[static_cast<std::size_t>(error)];
  }
  [[nodiscard]] std::uint32_t good() const noexcept { return (*this)[FramingError::kNone]; }
  [[nodiscard]] std::uint32_t bad() const noexcept {
    return std::accumulate(of.begin() + 1, of.end(), std::uint32_t{0});
  }
};

/// A frame ready to send, with its zero byte.
struct SerialFrame {
  std::array<std::uint8_t, kMaxCobs + 1> buffer{};
  std::size_t size{0};

  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept {
    return {buffer.data(), size};
  }
};

/// Pre-condition: frame.size <= kMaxData.
[[nodiscard]] SerialFrame encodeSerial(const BusFrame& frame) noexcept;

/// What stood between two zero bytes.
struct DecodedSerial {
  FramingError error{FramingError::kNone};
  BusFrame frame;  ///< Set if there is no error.
};
[[nodiscard]] DecodedSerial decodeSerial(std::span<const std::uint8_t> cobs) noexcept;

/// Cuts a byte stream at its zero bytes. What is too long is discarded up to the next zero byte, so
/// the frame after it is whole again. How the stream is split into calls makes no difference.
class FrameAssembler {
 public:
  /// Calls `on_frame(const DecodedSerial&)` for each frame. Empty ones are skipped.
  template <class OnFrame>
  void push(std::span<const std::uint8_t> bytes, OnFrame&& on_frame) noexcept {
    for (const std::uint8_t byte : bytes) {
      if (byte != 0) {
        if (size_ < buffer_.size()) buffer_[size_] = byte;
        size_ += size_ <= buffer_.size() ? 1 : 0;  // one more than fits: too long
        continue;
      }
      if (size_ > buffer_.size()) {
        on_frame(DecodedSerial{.error = FramingError::kTooLong, .frame = {}});
      } else if (size_ > 0) {
        on_frame(decodeSerial(std::span(buffer_.data(), size_)));
      }
      reset();
    }
  }

  /// Forgets an unfinished frame, e.g. when the link was lost in its middle.
  void reset() noexcept { size_ = 0; }

 private:
  std::array<std::uint8_t, kMaxCobs> buffer_{};
  std::size_t size_{0};
};

}  // namespace tautline::bus
