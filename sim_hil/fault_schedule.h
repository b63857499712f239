#pragma once

/// @file
/// Which faults act now, and what several of them need: chance that leaves the rest of the flight
/// alone, a contact that comes and goes, and readings of a moment ago.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "sim_hil/fault.h"
#include "sim_hil/random.h"

namespace tautline::sim {

/// Everything: real-time safe: no allocation, no locks, no exceptions.
class FaultSchedule {
 public:
  /// `seed` of what the faults leave to chance; plant and sensors draw from their own.
  explicit FaultSchedule(std::uint64_t seed) noexcept : random_(seed ^ kStream) {}

  /// False if there is no room left; faults that are over make room.
  bool add(const Fault& fault) noexcept {
    if (count_ == std::ssize(faults_)) return false;
    faults_[static_cast<std::size_t>(count_++)] = fault;
    return true;
  }

  /// To be called before the faults of `now` are asked for.
  void update(Time now) noexcept {
    now_ = now;
    const auto over = [now](const Fault& f) { return now >= f.at + f.lasting; };
    const auto last = std::remove_if(faults_.begin(), faults_.begin() + count_, over);
    count_ = static_cast<std::ptrdiff_t>(last - faults_.begin());
  }

  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] Time now() const noexcept { return now_; }

  /// The newest one of this kind that acts now; null if there is none, or if the target is `ok`.
  [[nodiscard]] const Fault* active(FaultTarget target, FaultMode mode) const noexcept {
    const Fault* found = nullptr;
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
      const Fault& f = faults_[static_cast<std::size_t>(i)];
      if (f.target != target || now_ < f.at) continue;
      if (f.mode == FaultMode::kOk) return nullptr;
      if (f.mode == mode) found = &f;
    }
    return found;
  }

  /// Calls `visit(const Fault&)` for every one of this kind that acts now.
  template <class Visit>
  void forEachActive(FaultTarget target, FaultMode mode, Visit&& visit) const noexcept {
    if (active(target, mode) == nullptr) return;
    for (std::ptrdiff_t i = 0; i < count_; ++i) {
      const Fault& f = faults_[static_cast<std::size_t>(i)];
      if (f.target == target && f.mode == mode && now_ >= f.at) visit(f);
    }
  }

  [[nodiscard]] Random& random() noexcept { return random_; }
  /// True with this probability.
  [[nodiscard]] bool chance(double share) noexcept {
    return 0.5 * (1.0 + random_.signedUniform()) < share;
  }

 private:
  static constexpr std::uint64_t kStream = 0x5DEECE66D1F0ULL;  // any other than the plant's

  std::array<Fault, kMaxFaults> faults_{};
  std::ptrdiff_t count_{0};
  Time now_{};
  Random random_;
};

/// A loose contact: open and closed by turns of random length.
class LooseContact {
 public:
  /// Whether it is open now, while `fault` acts; its value is the mean length of a turn [s].
  [[nodiscard]] bool open(const Fault* fault, FaultSchedule& faults) noexcept {
    if (fault == nullptr) {
      open_ = false;
      next_ = {};
      return false;
    }
    if (faults.now() >= next_) {
      open_ = !open_;
      next_ =
          faults.now() + fromSeconds(fault->value * (1.0 + 0.9 * faults.random().signedUniform()));
    }
    return open_;
  }

 private:
  bool open_{false};
  Time next_{};
};

/// What was a moment ago. Keeps the last kCapacity values.
template <class T, std::size_t kCapacity>
class History {
 public:
  void put(Time now, const T& value) noexcept { entries_[head_++ % kCapacity] = {now, value}; }

  /// The newest value that is not after `t`; the oldest one there is if all are.
  [[nodiscard]] T at(Time t) const noexcept {
    const std::size_t tail = head_ > kCapacity ? head_ - kCapacity : 0;
    std::size_t i = head_;
    while (i > tail + 1 && entries_[(i - 1) % kCapacity].time > t) --i;
    return i == 0 ? T{} : entries_[(i - 1) % kCapacity].value;
  }

 private:
  struct Entry {
    Time time{};
    T value{};
  };
  std::array<Entry, kCapacity> entries_{};
  std::size_t head_{0};
};

}  // namespace tautline::sim
