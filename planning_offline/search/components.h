#pragma once

/// @file
/// Numbers for directional components: a cell together with the direction it was entered by. Not
/// real-time safe: offline only.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "planning_offline/map/lattice.h"

namespace tautline::planning {

/// Components of one lattice, numbered without gaps: the lattice's own directions a cell, and one
/// more without a direction for the path's start.
class Components {
 public:
  using Id = std::int64_t;
  static constexpr Id kNone = -1;

  Components(const Lattice& lattice, CellIndex start) : lattice_(&lattice), start_(start) {
    slot_.fill(0);
    for (std::size_t k = 0; k < lattice.directions().size(); ++k) {
      slot_[static_cast<std::size_t>(lattice.directions()[k])] = static_cast<Id>(k);
    }
  }

  [[nodiscard]] std::size_t size() const noexcept {
    return static_cast<std::size_t>(startId()) + 1;
  }
  [[nodiscard]] Id startId() const noexcept {
    return static_cast<Id>(lattice_->shape().size() * lattice_->directions().size());
  }
  /// `d` one of the lattice's directions, or kNoDirection for the start.
  [[nodiscard]] Id id(CellIndex cell, Direction d) const noexcept {
    if (d == kNoDirection) return startId();
    return static_cast<Id>(cell) * count() + slot_[static_cast<std::size_t>(d)];
  }
  [[nodiscard]] CellIndex cell(Id id) const noexcept {
    return id == startId() ? start_ : static_cast<CellIndex>(id / count());
  }
  [[nodiscard]] Direction direction(Id id) const noexcept {
    if (id == startId()) return kNoDirection;
    return lattice_->directions()[static_cast<std::size_t>(id % count())];
  }

 private:
  [[nodiscard]] Id count() const noexcept { return static_cast<Id>(lattice_->directions().size()); }

  const Lattice* lattice_;
  CellIndex start_;
  std::array<Id, kDirections> slot_{};
};

inline constexpr double kInfiniteCost = std::numeric_limits<double>::infinity();

}  // namespace tautline::planning
