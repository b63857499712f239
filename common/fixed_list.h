#pragma once

/// @file
/// A list whose room is part of its type, for what is read at start-up and used inside the loop.

#include <array>
#include <cstddef>
#include <span>

namespace tautline {

/// At most N values. Real-time safe: no allocation, no locks, no exceptions.
template <class T, std::size_t N>
class FixedList {
 public:
  static constexpr std::size_t kCapacity = N;

  /// False, and nothing is added, when the list is full.
  bool add(const T& value) noexcept {
    if (count_ == N) return false;
    values_[count_++] = value;
    return true;
  }
  void clear() noexcept { count_ = 0; }

  [[nodiscard]] std::span<const T> all() const noexcept { return {values_.data(), count_}; }
  [[nodiscard]] std::span<T> all() noexcept { return {values_.data(), count_}; }

 private:
  std::array<T, N> values_{};
  std::size_t count_{0};
};

}  // namespace tautline
