#pragma once

/// @file
/// What the fast search keeps of every free cell, and the bucket queue that it takes cells from
/// (docs/fast_search.md, "Memory"). Not real-time safe: offline only.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "planning_offline/map/lattice.h"

namespace tautline::planning {

/// The labels of one cell, one cache line: cost of the best walk known that arrives by a direction
/// = (bucket << shift) + offset.
struct alignas(64) CellLabels {
  static constexpr std::uint16_t kNone = 0xFFFF;  ///< Offset of a label that is not there.
  static constexpr std::uint32_t kReached = std::uint32_t{1} << 31;
  static constexpr std::uint32_t kPending = (std::uint32_t{1} << kDirections) - 1;

  std::array<std::uint16_t, kDirections> offset;
  std::uint16_t queued;  ///< Bucket that the cell waits in (its low bits); only if labels pend.
  std::uint16_t least;   ///< Offset of the least label.
  std::uint32_t bucket;  ///< That the first label was made in: no label is below its start.
  std::uint32_t state;   ///< Bits 0 … 25: labels to be expanded yet; 26 … 30: direction of the
                         ///< least label; 31: reached. Nothing else counts if it is zero.

  [[nodiscard]] bool reached() const noexcept { return state != 0; }
  [[nodiscard]] Direction best() const noexcept {
    return static_cast<Direction>(state >> kDirections & 31U);
  }
};
static_assert(sizeof(CellLabels) == 64);

/// What is asked of a neighbour before its labels are touched.
struct Gate {
  std::uint16_t locale;  ///< UnitCosts::locale()
  std::uint16_t least;   ///< Low bits of the least label, coarser and odd; 0 = not reached.
};
static_assert(sizeof(Gate) == 4);

/// Cells by bucket, in the order they came; buckets beyond the farthest come round again. Emptied
/// buckets give their memory to new ones.
class BucketQueue {
 public:
  /// `span`: most buckets from the one being emptied to the farthest one filled.
  explicit BucketQueue(std::size_t span) : ring_(std::bit_ceil(span + 1)) {}

  void push(std::uint32_t bucket, CellIndex cell) {
    std::vector<CellIndex>& cells = at(bucket);
    if (cells.capacity() == 0 && !spare_.empty()) {
      cells = std::move(spare_.back());
      spare_.pop_back();
    }
    cells.push_back(cell);
    ++size_;
  }
  [[nodiscard]] std::vector<CellIndex>& at(std::uint32_t bucket) noexcept {
    return ring_[bucket & (ring_.size() - 1)];
  }
  void release(std::uint32_t bucket) {
    std::vector<CellIndex>& cells = at(bucket);
    if (cells.capacity() == 0) return;
    size_ -= cells.size();
    cells.clear();
    spare_.push_back(std::move(cells));
    cells = {};
  }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] std::size_t bytes() const noexcept {
    std::size_t bytes = 0;
    for (const auto* lists : {&ring_, &spare_}) {
      for (const auto& cells : *lists) bytes += sizeof cells + cells.capacity() * sizeof(CellIndex);
    }
    return bytes;
  }

 private:
  std::vector<std::vector<CellIndex>> ring_;
  std::vector<std::vector<CellIndex>> spare_;
  std::size_t size_{0};
};

}  // namespace tautline::planning
