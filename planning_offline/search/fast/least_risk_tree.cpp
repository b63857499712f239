#include "planning_offline/search/least_risk_tree.h"

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "planning_offline/search/fast/directional_search.h"

namespace tautline::planning {
namespace {

// Components up to which the reference is fast enough to be preferred: it rounds nothing.
constexpr std::size_t kReferenceMax = 300'000;

std::size_t componentsOf(const Lattice& lattice) {
  return lattice.freeCount() * lattice.directions().size();
}

class UnitTree final : public LeastRiskTree {
 public:
  UnitTree(const Lattice& lattice, const RiskModel& risk, UnitCosts units, CellIndex start)
      : lattice_(lattice),
        search_(lattice, std::move(units), risk.costs().locale, start),
        start_cost_(risk.startCost(start)),
        components_(static_cast<double>(componentsOf(lattice))) {}

  void run(const Progress& progress) { search_.run(progress); }

  [[nodiscard]] double costTo(CellIndex cell) const override {
    const auto least = search_.least(cell);
    if (!least) return std::numeric_limits<double>::infinity();
    return start_cost_ + static_cast<double>(*least) * search_.units().unit();
  }
  [[nodiscard]] std::optional<WalkEnd> lastOf(CellIndex cell) const override {
    if (!search_.least(cell)) return std::nullopt;
    return WalkEnd{cell, search_.bestIncoming(cell)};
  }
  [[nodiscard]] WalkEnd before(const WalkEnd& end) const override {
    return {lattice_.neighbour(end.cell, opposite(end.incoming)),
            search_.incomingBefore(end.cell, end.incoming)};
  }
  // Units are rounded down: only the double's own rounding can be above, unless steps of no cost
  // were raised to a unit. Of those, the best walk takes each once at most.
  [[nodiscard]] double costError() const override {
    const double raised = search_.units().raised() ? components_ : 0.0;
    return search_.units().unit() * (1.0 + raised);
  }
  [[nodiscard]] std::size_t expanded() const override { return search_.expanded(); }
  [[nodiscard]] bool complete() const override { return search_.complete(); }

 private:
  const Lattice& lattice_;
  DirectionalSearch search_;
  double start_cost_;
  double components_;
};

std::optional<UnitCosts> unitsOf(const Lattice& lattice, const RiskModel& risk) {
  UnitCosts::Access access;
  if (!risk.costs().character.empty())
    access = [&risk](CellIndex from, CellIndex to) { return risk.accessCost(from, to); };
  return UnitCosts::make(lattice, risk.costs(), std::move(access));
}

}  // namespace

std::unique_ptr<LeastRiskTree> leastRiskTreeFast(const Lattice& lattice, const RiskModel& risk,
                                                 CellIndex start, int /*threads*/,
                                                 const Progress& progress) {
  const bool allowed = std::isfinite(risk.costs().locale[static_cast<std::size_t>(start)]);
  std::optional<UnitCosts> units = unitsOf(lattice, risk);
  if (!allowed || !units) return leastRiskTreeReference(lattice, risk, start, progress);
  auto tree = std::make_unique<UnitTree>(lattice, risk, std::move(*units), start);
  tree->run(progress);
  return tree;
}

std::unique_ptr<LeastRiskTree> leastRiskTree(const Lattice& lattice, const RiskModel& risk,
                                             CellIndex start, int threads,
                                             const Progress& progress) {
  if (componentsOf(lattice) <= kReferenceMax)
    return leastRiskTreeReference(lattice, risk, start, progress);
  return leastRiskTreeFast(lattice, risk, start, threads, progress);
}

}  // namespace tautline::planning
