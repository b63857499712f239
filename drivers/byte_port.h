#pragma once

/// @file
/// A stream of bytes to and from a device, as the driver sees it: never blocking, never failing
/// loudly. Implemented by SerialPort (a real or pseudo terminal) and by the in-memory port of the
/// lock-step bench.

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/time.h"
#include "common/vehicle.h"

namespace tautline {

struct ReadResult {
  std::size_t count{0};  ///< Bytes put into the buffer; 0 = nothing there now, a normal state.
};

struct WriteResult {
  bool accepted{false};  ///< The message will go out as a whole. False: not connected or longer
                         ///< than the port's buffer.
};

/// Totals since the port was made; they never go back.
struct PortCounters {
  std::uint64_t bytes_in{0};
  std::uint64_t bytes_out{0};
  std::uint32_t bytes_dropped{0};  ///< Output that never reached the device.
  std::uint32_t reconnects{0};     ///< Times the link came back after it had been lost.
};

/// Real-time safe: no allocation, no locks, no exceptions; no method waits for the device.
class BytePort {
 public:
  BytePort() = default;
  BytePort(const BytePort&) = delete;
  BytePort& operator=(const BytePort&) = delete;
  virtual ~BytePort() = default;

  /// Once a cycle, before read(): brings a lost link back when it is time to, and sends what is
  /// still waiting.
  virtual void poll(Time now) noexcept = 0;

  /// Takes up to buffer.size() of the bytes that have arrived.
  [[nodiscard]] virtual ReadResult read(std::span<std::uint8_t> buffer) noexcept = 0;

  /// Queues one message. A message is sent whole or not at all; when the device does not take
  /// bytes, the oldest waiting messages give way to newer ones and are counted in
  /// PortCounters::bytes_dropped.
  virtual WriteResult write(std::span<const std::uint8_t> message) noexcept = 0;

  [[nodiscard]] virtual bool connected() const noexcept = 0;
  [[nodiscard]] virtual PortCounters counters() const noexcept = 0;

  /// Why there is no link; kNone while connected.
  [[nodiscard]] virtual LinkFault fault() const noexcept = 0;
};

}  // namespace tautline
