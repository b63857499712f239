#pragma once

/// @file
/// The Tautline bus's messages on the wires that the simulator serves, each as a stream of bytes:
/// COBS frames of the serial line, SLCAN text of a CAN adapter on a serial line, and the kernel's
/// can_frame records of a CAN socket. The simulator's own encoders and parsers.
///
/// Everything here: real-time safe: no allocation, no locks, no exceptions.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/fields.h"
#include "drivers/tautline_protocol.h"
#include "sim_hil/tautline_frame.h"

namespace tautline::sim {

enum class Wire : std::uint8_t { kCobs, kSlcan, kCanFrame };

/// A few bytes for the client.
struct WireBytes {
  std::array<std::uint8_t, 32> buffer{};
  std::size_t size{0};

  void put(unsigned byte) noexcept {
    if (size < buffer.size()) buffer[size++] = static_cast<std::uint8_t>(byte);
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept {
    return {buffer.data(), size};
  }
};

/// One message as it stands on `wire`.
[[nodiscard]] WireBytes encodeFrame(Wire wire, const TautlineFrame& frame) noexcept;

/// Bytes of a wire back to messages, however they are split.
class WireParser {
 public:
  explicit WireParser(Wire wire) noexcept : wire_(wire) {}

  /// Calls `on_frame(const TautlineFrame&)` for each whole message and `on_reply(bytes)` where the
  /// client expects an answer (SLCAN commands).
  template <class OnFrame, class OnReply>
  void push(std::span<const std::uint8_t> bytes, OnFrame&& on_frame, OnReply&& on_reply) noexcept {
    for (const std::uint8_t byte : bytes) {
      TautlineFrame frame;
      WireBytes reply;
      if (take(byte, frame, reply)) on_frame(frame);
      if (reply.size > 0) on_reply(reply.bytes());
    }
  }

  /// Pieces that were no message.
  [[nodiscard]] std::uint32_t bad() const noexcept { return bad_; }

 private:
  [[nodiscard]] bool take(std::uint8_t byte, TautlineFrame& frame, WireBytes& reply) noexcept;
  [[nodiscard]] bool takeCobs(TautlineFrame& frame) noexcept;
  [[nodiscard]] bool takeSlcan(TautlineFrame& frame, WireBytes& reply) noexcept;
  [[nodiscard]] bool takeRecord(TautlineFrame& frame) noexcept;

  Wire wire_;
  std::array<std::uint8_t, 40> piece_{};
  std::size_t size_{0};  // one more than fits: too long
  std::uint32_t bad_{0};
};

}  // namespace tautline::sim
