#pragma once

/// @file
/// Consecutive numbers for the free cells of a lattice, in the order of their indices: a quarter of
/// a byte a cell of the map, so that a search keeps state of free cells only. Not real-time safe:
/// offline only.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "planning_offline/map/lattice.h"
#include "planning_offline/multiversion.h"

namespace tautline::planning {

class FreeCells {
 public:
  explicit FreeCells(const Lattice& lattice)
      : margin_(static_cast<std::size_t>(lattice.shape().nx) *
                    static_cast<std::size_t>(lattice.shape().ny + 1) +
                1),
        words_((lattice.shape().size() + 2 * margin_) / 32 + 1) {
    const auto free = lattice.freeCells();
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (free[i] != 0) words_[(i + margin_) / 32].bits |= std::uint32_t{1} << (i + margin_) % 32;
    }
    std::uint32_t before = 0;
    for (Word& word : words_) {
      word.before = before;
      before += static_cast<std::uint32_t>(std::popcount(word.bits));
    }
  }

  struct Number {
    std::uint32_t number;  ///< Free cells before this one.
    std::uint32_t free;    ///< 1 if this one is free, else 0.
  };
  /// Of a cell or of one of its 26 neighbours, which may be off the map and are not free then.
  [[nodiscard]] TAUTLINE_INLINE Number operator[](CellIndex cell) const noexcept {
    const auto i = static_cast<std::size_t>(cell + static_cast<CellIndex>(margin_));
    const Word word = words_[i / 32];
    const auto bit = static_cast<std::uint32_t>(i % 32);
    const std::uint32_t below = word.bits & ((std::uint32_t{1} << bit) - 1);
    return {word.before + static_cast<std::uint32_t>(std::popcount(below)), word.bits >> bit & 1U};
  }

  [[nodiscard]] std::size_t bytes() const noexcept { return words_.size() * sizeof(Word); }

 private:
  struct Word {
    std::uint32_t bits{0};
    std::uint32_t before{0};
  };
  std::size_t margin_;  ///< Cells that a neighbour's index may be beyond either end.
  std::vector<Word> words_;
};

}  // namespace tautline::planning
