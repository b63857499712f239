#pragma once

/// @file
/// Least cost from every directional component to one goal: the search of least_risk_tree.h run
/// backwards. It grows only as far as it is asked, so that a goal-directed search pays for the part
/// of the map it looks at. Memory: 4 B a cell; 4 B and 16 B a direction of the lattice's
/// connectivity for each free cell; 16 B for each entry of the queue. Not real-time safe: offline
/// only.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "planning_offline/map/lattice.h"
#include "planning_offline/risk/risk_model.h"
#include "planning_offline/search/components.h"

namespace tautline::planning {

class CostToGo {
 public:
  struct Hooks {
    /// Cost >= 0 that a step has besides that of locale and action elements, such as a lower bound
    /// of the traverse elements; empty: none.
    std::function<double(CellIndex to, Direction by)> extra;
    /// Asked at each expansion; true ends the search for good. Empty: never.
    std::function<bool()> stop;
  };

  /// `lattice` and `risk` must outlive it.
  CostToGo(const Lattice& lattice, const RiskModel& risk, CellIndex start, CellIndex goal,
           Hooks hooks);

  /// Cost of the steps still to make from `cell`, entered by `incoming` (kNoDirection: the start,
  /// before the first step), to the goal; 0 at the goal, infinite where no way leads. A lower bound
  /// of it once the search was stopped.
  [[nodiscard]] double cost(CellIndex cell, Direction incoming);

  /// First step of that way; kNoDirection at the goal, where no way leads and where none is known.
  [[nodiscard]] Direction next(CellIndex cell, Direction incoming);

  [[nodiscard]] std::size_t expanded() const noexcept { return expanded_; }

 private:
  struct Label {
    double cost{kInfiniteCost};
    std::int8_t next{kNoDirection};
    bool closed{false};
  };
  /// Components of free cells, in the order of their cells and then directions; the start, before
  /// the first step, is the last.
  using Id = std::int64_t;
  using Entry = std::pair<double, Id>;

  [[nodiscard]] Id startId() const noexcept { return static_cast<Id>(labels_.size()) - 1; }
  /// `cell` free, or `d` kNoDirection.
  [[nodiscard]] Id idOf(CellIndex cell, Direction d) const noexcept {
    if (d == kNoDirection) return startId();
    return number_[static_cast<std::size_t>(cell)] * count_ + slot_[static_cast<std::size_t>(d)];
  }
  /// No way leads to or from there, whatever the search says.
  [[nodiscard]] bool blocked(CellIndex cell, Direction incoming) const noexcept {
    return incoming != kNoDirection && !lattice_->free(cell);
  }

  /// The component's label, closed if a way leads from there and the search was not stopped.
  [[nodiscard]] const Label& settle(CellIndex cell, Direction incoming);
  void expand(Id id);
  void offer(Id id, double cost, Direction next);

  const Lattice* lattice_;
  const RiskModel* risk_;
  CellIndex start_;
  CellIndex goal_;
  Hooks hooks_;
  Id count_;                            // directions a cell
  std::array<Id, kDirections> slot_{};  // of each direction among them
  std::vector<std::int32_t> number_;    // of each free cell among the free ones
  std::vector<CellIndex> cells_;        // the free ones, ascending
  std::vector<Label> labels_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::size_t expanded_{0};
  bool stopped_{false};
};

}  // namespace tautline::planning
