#pragma once

/// @file
/// Hash map from packed 64-bit keys to 32-bit numbers, open addressing, 12 bytes a slot: search
/// states by the tens of millions. Not real-time safe: offline only.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tautline::planning {

class FlatIndex {
 public:
  using Key = std::uint64_t;  ///< Any but ~0.
  static constexpr std::uint32_t kNew = ~std::uint32_t{0};

  FlatIndex() { clear(); }

  /// The number of `key`; kNew, to be set by the caller, if the key was not there. The reference
  /// holds until the next call.
  [[nodiscard]] std::uint32_t& operator[](Key key) {
    if (size_ * 3 >= keys_.size() * 2) grow();
    const std::size_t slot = slotOf(key);
    if (keys_[slot] == kFree) {
      keys_[slot] = key;
      ++size_;
    }
    return values_[slot];
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }

  void clear() {
    keys_.assign(kSmallest, kFree);
    values_.assign(kSmallest, kNew);
    size_ = 0;
  }

 private:
  static constexpr Key kFree = ~Key{0};
  static constexpr std::size_t kSmallest = 64;  // a power of two, as all sizes

  [[nodiscard]] std::size_t slotOf(Key key) const noexcept {
    const std::size_t mask = keys_.size() - 1;
    Key h = key * 0x9E3779B97F4A7C15U;  // Fibonacci hashing; the high half holds the mix
    h ^= h >> 32;
    std::size_t slot = static_cast<std::size_t>(h) & mask;
    while (keys_[slot] != kFree && keys_[slot] != key) slot = (slot + 1) & mask;
    return slot;
  }

  void grow() {
    std::vector<Key> keys(keys_.size() * 2, kFree);
    std::vector<std::uint32_t> values(keys.size(), kNew);
    keys.swap(keys_);
    values.swap(values_);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (keys[i] == kFree) continue;
      const std::size_t slot = slotOf(keys[i]);
      keys_[slot] = keys[i];
      values_[slot] = values[i];
    }
  }

  std::vector<Key> keys_;
  std::vector<std::uint32_t> values_;
  std::size_t size_{0};
};

}  // namespace tautline::planning
