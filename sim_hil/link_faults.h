#pragma once

/// @file
/// Faults of the link between the emulated device and its client, one direction of bytes each.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sim_hil/fault_schedule.h"

namespace tautline::sim {

/// Bytes on their way. While no fault acts and nothing is under way, they need not pass it.
/// Everything: real-time safe: no allocation, no locks, no exceptions.
class FaultyLink {
 public:
  /// Which of link.vehicle, link.uplink and bus cut this direction.
  explicit FaultyLink(bool uplink) noexcept : uplink_(uplink) {}

  /// To be asked in every cycle: whether bytes have to go through here.
  [[nodiscard]] bool needed(FaultSchedule& faults) noexcept;

  /// Bytes enter now. What does not fit is lost.
  void put(std::span<const std::uint8_t> bytes, FaultSchedule& faults) noexcept;

  /// Takes what has arrived by now; returns how many bytes were written to `out`.
  [[nodiscard]] std::size_t take(std::span<std::uint8_t> out, FaultSchedule& faults) noexcept;

 private:
  static constexpr std::size_t kBytes = 1U << 16U;
  static constexpr std::size_t kPieces = 4096;

  /// Bytes that entered together.
  struct Piece {
    Time due{};
    std::size_t size{0};
  };

  [[nodiscard]] const Fault* active(FaultMode mode, const FaultSchedule& faults) const noexcept;
  [[nodiscard]] bool cut(const FaultSchedule& faults) const noexcept;

  bool uplink_;
  LooseContact contact_;
  bool open_{false};
  std::array<std::uint8_t, kBytes> bytes_{};
  std::size_t head_{0};
  std::size_t tail_{0};
  std::array<Piece, kPieces> pieces_{};
  std::size_t piece_head_{0};
  std::size_t piece_tail_{0};
  double budget_{0.0};  // bytes that may pass now, while slow
  Time last_take_{};
};

}  // namespace tautline::sim
