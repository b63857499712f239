#pragma once

/// @file
/// Faults of single messages on the Tautline bus, on their way from the devices.

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include "sim_hil/fault_schedule.h"
#include "sim_hil/tautline_frame.h"

namespace tautline::sim {

/// Everything: real-time safe: no allocation, no locks, no exceptions.
class FrameFaults {
 public:
  /// What comes out when `frame` goes in: none while it waits for the next of its kind, two when it
  /// is doubled or has waited.
  class Result {
   public:
    void put(const TautlineFrame& frame) noexcept { frames_[count_++] = frame; }
    [[nodiscard]] bool empty() const noexcept { return taken_ == count_; }
    /// The next one; only if not empty.
    [[nodiscard]] const TautlineFrame& take() noexcept { return frames_[taken_++]; }

   private:
    std::array<TautlineFrame, 3> frames_;
    std::size_t count_{0};
    std::size_t taken_{0};
  };

  [[nodiscard]] Result pass(TautlineFrame frame, FaultSchedule& faults) noexcept {
    Result result;
    if (faults.empty() && !anyWaiting()) {
      result.put(frame);
      return result;
    }
    if (drawn(FaultMode::kCrc, faults)) {
      const double bit = 4.0 * (1.0 + faults.random().signedUniform()) * frame.size;
      const auto place = static_cast<unsigned>(bit);
      frame.data[place / 8U] ^= static_cast<std::uint8_t>(1U << place % 8U);
    }
    std::optional<TautlineFrame>& before = waiting_[frame.id % waiting_.size()];
    if (!before && drawn(FaultMode::kReorder, faults)) {
      before = frame;
      return result;
    }
    result.put(frame);
    if (before) result.put(*before);
    before.reset();
    if (drawn(FaultMode::kDup, faults)) result.put(frame);
    return result;
  }

 private:
  [[nodiscard]] static bool drawn(FaultMode mode, FaultSchedule& faults) noexcept {
    const Fault* fault = faults.active(FaultTarget::kBus, mode);
    return fault != nullptr && faults.chance(fault->value);
  }
  [[nodiscard]] bool anyWaiting() const noexcept {
    return std::any_of(waiting_.begin(), waiting_.end(),
                       [](const auto& w) { return w.has_value(); });
  }

  /// By identifier; those of the bus differ modulo the size.
  std::array<std::optional<TautlineFrame>, 64> waiting_{};
};

}  // namespace tautline::sim
