#pragma once

/// @file
/// One message of a field bus and the port that carries such messages: a CAN interface, or a serial
/// line with framing. Never blocking, never failing loudly.

#include <array>
#include <cstdint>
#include <span>

#include "common/time.h"
#include "common/vehicle.h"
#include "drivers/byte_port.h"

namespace tautline {

struct BusFrame {
  std::uint16_t id{0};   ///< 11 bits.
  std::uint8_t size{0};  ///< Of the data [byte], 0 to 8.
  std::array<std::uint8_t, 8> data{};
  Time time{};  ///< Received: when, by the kernel's stamp where there is one. Sent: not used.

  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept { return {data.data(), size}; }
};

/// What a port of frames counts beyond bytes; totals that never go back.
struct FrameCounters {
  std::uint32_t frames_in{0};       ///< Whole frames handed on.
  std::uint32_t frames_bad{0};      ///< Cut or garbled on the way in; a CAN controller hides those.
  std::uint32_t frames_foreign{0};  ///< Whole, and none of ours.
  std::uint32_t frames_lost{0};     ///< Given up by the kernel because nobody read in time.
  std::uint32_t bus_errors{0};      ///< Error frames of the CAN controller.
  std::uint32_t bus_off{0};         ///< Times that the controller went off the bus.
  std::uint32_t no_buffer{0};       ///< Frames that the kernel had no room to send.
};

/// Real-time safe: no allocation, no locks, no exceptions; no method waits for the device.
class FramePort {
 public:
  FramePort() = default;
  FramePort(const FramePort&) = delete;
  FramePort& operator=(const FramePort&) = delete;
  virtual ~FramePort() = default;

  /// Once a cycle, before read(): brings a lost link back when it is time to, and starts a new
  /// budget of frames for this cycle.
  virtual void poll(Time now) noexcept = 0;

  /// The next frame that has arrived. False: none, or this cycle's budget is used up.
  [[nodiscard]] virtual bool read(BusFrame& out) noexcept = 0;

  /// False: not taken; the caller may try again in a later cycle.
  virtual bool write(const BusFrame& frame) noexcept = 0;

  [[nodiscard]] virtual bool connected() const noexcept = 0;
  [[nodiscard]] virtual PortCounters counters() const noexcept = 0;
  [[nodiscard]] virtual FrameCounters frameCounters() const noexcept = 0;

  /// Of the bytes that came in, those of plain text: where the port sees a stream of bytes.
  [[nodiscard]] virtual std::uint64_t textBytes() const noexcept { return 0; }

  /// What is known to be wrong below the messages, or why there is no link; kNone if nothing is.
  [[nodiscard]] virtual LinkFault fault() const noexcept = 0;
};

}  // namespace tautline
