#include "planning_offline/planner/additive_cost.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include "planning_offline/search/components.h"

namespace tautline::planning {

std::vector<double> additiveCosts(const Lattice& lattice, const RiskModel& risk,
                                  AdditiveWeights weights) {
  const std::size_t cells = lattice.shape().size();
  std::vector<double> sum(cells, 0.0);
  for (const RiskElement element : risk.enabled()) {
    if (depthOf(element) != RiskDepth::kLocale) continue;
    std::vector<double> value(cells, 0.0);
    double largest = 0.0;
    for (std::size_t i = 0; i < cells; ++i) {
      const auto cell = static_cast<CellIndex>(i);
      if (!lattice.free(cell)) continue;
      const double r = risk.localeRisk(element, cell);
      value[i] = r < 1.0 ? r : kInfiniteCost;
      if (r < 1.0) largest = std::max(largest, r);
    }
    const bool normalize = weights == AdditiveWeights::kNormalized && largest > 0.0;
    const double scale = normalize ? 1.0 / largest : 1.0;
    for (std::size_t i = 0; i < cells; ++i) sum[i] += scale * value[i];
  }
  for (std::size_t i = 0; i < cells; ++i) {
    if (!lattice.free(static_cast<CellIndex>(i))) sum[i] = kInfiniteCost;
  }
  return sum;
}

AdditivePaths additivePaths(const Lattice& lattice, const std::vector<double>& cell_cost,
                            CellIndex start, const std::function<bool()>& stop,
                            std::optional<CellIndex> goal) {
  const auto at = [](CellIndex i) { return static_cast<std::size_t>(i); };
  using Entry = std::tuple<double, std::int32_t, CellIndex>;  // cost, steps, cell
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  AdditivePaths found{.cost = std::vector<double>(cell_cost.size(), kInfiniteCost),
                      .before = std::vector<CellIndex>(cell_cost.size(), kNoCell)};
  std::vector<std::int32_t> steps(cell_cost.size(), 0);
  const auto offer = [&](CellIndex v, double cost, std::int32_t n, CellIndex before) {
    if (!(cost < kInfiniteCost) ||
        std::tuple(cost, n, before) >=
            std::tuple(found.cost[at(v)], steps[at(v)], found.before[at(v)])) {
      return;
    }
    found.cost[at(v)] = cost;
    found.before[at(v)] = before;
    steps[at(v)] = n;
    queue.emplace(cost, n, v);
  };
  offer(start, cell_cost[at(start)], 0, kNoCell);
  while (!queue.empty() && found.complete) {
    const auto [cost, n, u] = queue.top();
    queue.pop();
    if (cost != found.cost[at(u)] || n != steps[at(u)]) continue;
    if (stop()) found.complete = false;
    ++found.expanded;
    if (u == goal) break;  // every later offer costs more, or as much in more steps
    const std::uint32_t moves = lattice.moves(u);
    for (const Direction d : lattice.directions()) {
      if ((moves >> d & 1U) == 0) continue;
      const CellIndex v = lattice.neighbour(u, d);
      offer(v, cost + cell_cost[at(v)], n + 1, u);
    }
  }
  return found;
}

std::vector<CellIndex> AdditivePaths::pathTo(CellIndex cell) const {
  std::vector<CellIndex> path;
  if (!(cost[static_cast<std::size_t>(cell)] < kInfiniteCost)) return path;
  for (CellIndex i = cell; i != kNoCell; i = before[static_cast<std::size_t>(i)]) path.push_back(i);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace tautline::planning
