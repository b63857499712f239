#pragma once

/// @file
/// Least cost from every directional component to one goal: the search of least_risk_tree.h run
/// backwards. It grows only as far as it is asked, so that a goal-directed search pays for the part
/// of the map it looks at. Not real-time safe: offline only.

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
  using Entry = std::pair<double, Components::Id>;

  /// The component's label, closed if a way leads from there and the search was not stopped.
  [[nodiscard]] const Label& settle(CellIndex cell, Direction incoming);
  void expand(Components::Id id);
  void offer(Components::Id id, double cost, Direction next);

  const Lattice* lattice_;
  const RiskModel* risk_;
  CellIndex goal_;
  Hooks hooks_;
  Components components_;
  std::vector<Label> labels_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::size_t expanded_{0};
  bool stopped_{false};
};

}  // namespace tautline::planning
