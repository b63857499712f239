#pragma once

/// @file
/// Bus frames over a stream of bytes: a FramePort on a serial line.

#include <array>
#include <cstdint>

#include "drivers/bus_frame.h"
#include "drivers/byte_port.h"
#include "drivers/cobs_codec.h"

namespace tautline {

/// Real-time safe: no allocation, no locks, no exceptions.
class CobsPort final : public FramePort {
 public:
  /// Frames handed on in one cycle at most; what is left waits for the next.
  static constexpr int kFramesPerCycle = 64;

  /// `bytes` must outlive this port.
  explicit CobsPort(BytePort& bytes) noexcept : bytes_(bytes) {}

  void poll(Time now) noexcept override;
  [[nodiscard]] bool read(BusFrame& out) noexcept override;
  bool write(const BusFrame& frame) noexcept override;
  [[nodiscard]] bool connected() const noexcept override { return bytes_.connected(); }
  [[nodiscard]] PortCounters counters() const noexcept override { return bytes_.counters(); }
  [[nodiscard]] FrameCounters frameCounters() const noexcept override;
  [[nodiscard]] LinkFault fault() const noexcept override { return bytes_.fault(); }
  [[nodiscard]] std::uint64_t textBytes() const noexcept override { return text_bytes_; }

  /// Frames by outcome since start.
  [[nodiscard]] const bus::FramingCounters& framing() const noexcept { return framing_; }

 private:
  void fill() noexcept;

  BytePort& bytes_;
  bus::FrameAssembler assembler_;
  bus::FramingCounters framing_;
  std::uint64_t text_bytes_{0};
  std::uint32_t reconnects_seen_{0};
  Time now_{};
  int budget_{0};
  /// Frames of the last piece of the stream that have not been handed on: no frame is shorter than
  /// seven bytes.
  static constexpr std::size_t kPiece = 64;
  std::array<BusFrame, kPiece / 7 + 1> waiting_{};
  std::size_t first_{0};
  std::size_t last_{0};
};

}  // namespace tautline
