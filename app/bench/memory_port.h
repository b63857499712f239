#pragma once

/// @file
/// The cable between driver and simulated device in lock-step: bytes in memory, no time passes in
/// them.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "drivers/byte_port.h"
#include "sim_hil/simulator.h"

namespace tautline::bench {

/// Which of the device's messages arrive.
struct MessageFilter {
  char end{'\n'};  ///< Last byte of a message.
  std::function<bool(const std::string& message)> keep;
};

/// A BytePort whose other end is a Simulator. Unplugging it makes both directions silent.
class MemoryPort final : public BytePort {
 public:
  explicit MemoryPort(sim::Simulator& simulator) noexcept : simulator_(simulator) {}

  void poll(Time now) noexcept override;
  [[nodiscard]] ReadResult read(std::span<std::uint8_t> buffer) noexcept override;
  WriteResult write(std::span<const std::uint8_t> message) noexcept override;
  [[nodiscard]] bool connected() const noexcept override { return connected_; }
  [[nodiscard]] PortCounters counters() const noexcept override { return counters_; }
  [[nodiscard]] LinkFault fault() const noexcept override {
    return connected_ ? LinkFault::kNone : LinkFault::kPortMissing;
  }

  void unplug() noexcept { connected_ = false; }
  void plug() noexcept;
  /// From now on only the messages that the filter keeps arrive; the heap is used.
  void cut(MessageFilter filter) { filter_ = std::move(filter); }

  /// From now on every n-th byte to the station has one bit turned over; 0: none.
  void garble(std::size_t n) noexcept { garble_every_ = n; }

 private:
  [[nodiscard]] std::size_t readFiltered(std::span<std::uint8_t> buffer);

  sim::Simulator& simulator_;
  PortCounters counters_;
  bool connected_{true};
  std::size_t garble_every_{0};
  std::size_t passed_{0};  ///< Bytes since garbling began.
  std::optional<MessageFilter> filter_;
  std::string message_;   ///< Not yet whole.
  std::string filtered_;  ///< Kept, not yet read.
};

}  // namespace tautline::bench
