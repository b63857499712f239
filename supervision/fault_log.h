#pragma once

/// @file
/// What ended or interrupted flights since the station's start, kept until an operator has looked.

#include <array>
#include <cstddef>

#include "common/time.h"
#include "supervision/condition.h"
#include "supervision/supervisor.h"

namespace tautline {

struct Fault {
  Time time{};
  Condition condition{};
  Mode mode{Mode::kStandby};  ///< It led to this mode.
};

/// The last 16 faults. Real-time safe: no allocation, no locks, no exceptions.
class FaultLog {
 public:
  static constexpr std::size_t kCapacity = 16;

  /// Call with every step of the supervisor: keeps the conditions behind a change into a failsafe
  /// mode that nobody asked for.
  void update(Time now, const SupervisorOutput& step) noexcept;

  /// An operator has looked: nothing is latched any more, the list stays.
  void acknowledge() noexcept { latched_ = false; }

  [[nodiscard]] bool latched() const noexcept { return latched_; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// Oldest first, i < count().
  [[nodiscard]] const Fault& operator[](std::size_t i) const noexcept {
    return faults_[(next_ + kCapacity - count_ + i) % kCapacity];
  }

 private:
  std::array<Fault, kCapacity> faults_{};
  std::size_t next_{0};
  std::size_t count_{0};
  bool latched_{false};
};

}  // namespace tautline
