#pragma once

/// @file
/// The cable between driver and simulated device in lock-step: bytes in memory, no time passes in
/// them.

#include "drivers/byte_port.h"
#include "sim_hil/simulator.h"

namespace tautline::bench {

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

  /// From now on every n-th byte to the station has one bit turned over; 0: none.
  void garble(std::size_t n) noexcept { garble_every_ = n; }

 private:
  sim::Simulator& simulator_;
  PortCounters counters_;
  bool connected_{true};
  std::size_t garble_every_{0};
  std::size_t passed_{0};  ///< Bytes since garbling began.
};

}  // namespace tautline::bench
