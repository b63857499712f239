#pragma once

/// @file
/// The one search behind `directional` with traverse elements, `lookback` and `tether`: labels
/// (cost, what the path carries) over states that remember a chosen part of the past.
///
///   memory        state                                       kept per state      least cost is
///   lookback n    cell × last n − 1 incoming directions        the cheapest label  as published
///   stack         cell × incoming direction × contact stack    all labels that     exact
///                                                              none dominates in
///                                                              cost, mud, energy
///
/// With a cost-to-go it is A*, else Dijkstra's search. Not real-time safe: offline only.

#include <cstdint>
#include <functional>
#include <optional>
#include <queue>
#include <vector>

#include "planning_offline/planner/budget.h"
#include "planning_offline/planner/traverse.h"
#include "planning_offline/search/cost_to_go.h"

namespace tautline::planning {

struct LabelSearchSettings {
  int lookback{2};                 ///< n; ignored if `stacks`.
  bool stacks{false};              ///< The state has the contact stack.
  CellIndex goal{kNoCell};         ///< kNoCell: all cells.
  CostToGo* to_go{nullptr};        ///< Lower bound of the cost from a state to the goal.
  double cost_max{kInfiniteCost};  ///< Labels that cannot end within it are left out.
};

class LabelSearch {
 public:
  /// `lattice` and `traverse` must outlive it.
  LabelSearch(const Lattice& lattice, Traverse& traverse, CellIndex start,
              LabelSearchSettings settings);

  /// Runs to the goal, or to all cells, or until the budget is spent (which it says).
  void run(Budget& budget, const char* what);

  /// Cost of the best label of a cell that was taken up; infinite if there is none.
  [[nodiscard]] double costTo(CellIndex cell) const;
  /// Its way, start first; empty if there is none.
  [[nodiscard]] std::vector<CellIndex> pathTo(CellIndex cell) const;

  /// Nothing that is still open ends below this: a lower bound if the search was cut.
  [[nodiscard]] double openCost() const;
  /// Way to the most promising open label, start first; empty if none is open.
  [[nodiscard]] std::vector<CellIndex> openPath() const;

  [[nodiscard]] std::int64_t expanded() const noexcept { return expanded_; }
  [[nodiscard]] std::int64_t labels() const noexcept {
    return static_cast<std::int64_t>(labels_.size());
  }

 private:
  using Index = std::uint32_t;
  static constexpr Index kNoLabel = FlatIndex::kNew;
  enum class Fate : std::uint8_t { kOpen, kClosed, kDominated };

  struct Label {
    double cost;
    CellIndex cell;
    Index parent;
    Index sibling;  // next label of the same state
    StackId stack;
    std::uint32_t steps;
    std::uint16_t history;  // last three incoming directions, five bits each, the latest lowest
    Fate fate;
  };
  struct Entry {
    double estimate;  // of the whole path's cost
    double cost;
    std::uint32_t steps;
    Index label;
    friend bool operator>(const Entry& a, const Entry& b) noexcept {
      if (a.estimate != b.estimate) return a.estimate > b.estimate;
      if (a.steps != b.steps) return a.steps > b.steps;
      return a.label > b.label;
    }
  };

  [[nodiscard]] FlatIndex::Key keyOf(const Label& label) const;
  [[nodiscard]] Accumulators sumsOf(Index i) const {
    return sums_.empty() ? Accumulators{} : sums_[i];
  }
  [[nodiscard]] bool stale(const Entry& entry) const;
  void dropStale();
  void expand(Index i);
  void offer(const Label& label, const Accumulators& sums);
  [[nodiscard]] Index place(const Label& label, const Accumulators& sums);
  [[nodiscard]] Index placeCheapest(Index& head, const Label& label, const Accumulators& sums);
  [[nodiscard]] Index placePareto(Index& head, const Label& label, const Accumulators& sums);
  [[nodiscard]] Index append(const Label& label, const Accumulators& sums);
  [[nodiscard]] std::vector<CellIndex> pathOf(Index i) const;

  const Lattice* lattice_;
  Traverse* traverse_;
  LabelSearchSettings settings_;
  std::vector<Label> labels_;
  std::vector<Accumulators> sums_;  // one a label; empty if nothing is summed
  FlatIndex states_;                // state -> its first label
  std::vector<Index> best_;         // one a cell: the first label taken up
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::int64_t expanded_{0};
};

}  // namespace tautline::planning
