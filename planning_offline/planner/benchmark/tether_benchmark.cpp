/// `tether` against the plain directional search and against the same states without a cost-to-go,
/// on the same maps and goals. Counter `expanded`: states taken up, mean a goal.
///
///     planning_tether_benchmark --benchmark_enable_random_interleaving=true

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "planning_offline/planner/label_search.h"
#include "planning_offline/planner/makers.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {
namespace {

/// A hall with obstacles in a part of its cells, by seed; goals far from the start in a corner.
struct Hall {
  std::shared_ptr<VoxelMap> map = std::make_shared<VoxelMap>();
  std::unique_ptr<Lattice> lattice;
  std::unique_ptr<RiskModel> risk;
  std::vector<CellIndex> goals;

  Hall(GridShape shape, Connectivity connectivity) {
    std::mt19937 random(shape.size());
    map->shape = shape;
    map->resolution = 0.4;
    std::vector<std::uint8_t> free;
    MapLayer locale{"terrain_stability", {}};
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const bool occupied = i != 0 && random() % 100 < 15;
      map->cells.push_back(occupied ? CellState::kOccupied : CellState::kFree);
      free.push_back(occupied ? 0 : 1);
      locale.values.push_back(static_cast<double>(random() % 1000) / 1000.0);
    }
    map->layers = {locale};
    lattice = std::make_unique<Lattice>(shape, connectivity, free);

    RiskParams params;
    params.distance.member.risk = 0.0;
    params.visibility.member.risk = 0.0;
    params.terrain_stability.scale = 0.02;
    risk =
        std::make_unique<RiskModel>(map, MapFields{}, params, makeTautString(*map, map->centre(0)));
    const auto tree = leastRiskTreeReference(*lattice, *risk, 0, Progress());
    while (goals.size() < 8) {
      const auto goal = static_cast<CellIndex>(random() % shape.size());
      const bool far = (shape.cell(goal).sum() * 2 > shape.nx + shape.nz);
      if (far && !tree->pathTo(goal).empty()) goals.push_back(goal);
    }
  }

  [[nodiscard]] PlanProblem problem() const {
    return {.lattice = lattice.get(), .risk = risk.get(), .reward = {}, .start = 0};
  }
};

Hall hallOf(const benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  return state.range(1) == 0 ? Hall({n, 1, n}, Connectivity::kEdges)
                             : Hall({n, 6, n}, Connectivity::kVertices);
}

/// Runs search(goal), which tells the expanded states, on each goal in turn.
template <class Search>
void forGoals(benchmark::State& state, const Hall& hall, Search search) {
  double expanded = 0.0;
  for (auto _ : state) {
    expanded = 0.0;
    for (const CellIndex goal : hall.goals) expanded += static_cast<double>(search(goal));
  }
  state.counters["expanded"] = expanded / static_cast<double>(hall.goals.size());
}

void plainDirectional(benchmark::State& state) {
  const Hall hall = hallOf(state);
  forGoals(state, hall, [&](CellIndex) {
    return leastRiskTreeReference(*hall.lattice, *hall.risk, 0, Progress())->expanded();
  });
}

void planWith(benchmark::State& state, std::unique_ptr<Planner> (*make)()) {
  const Hall hall = hallOf(state);
  double gap = 0.0;
  forGoals(state, hall, [&](CellIndex goal) {
    PlanOptions options;
    options.goal = goal;
    options.time_limit = 5.0;
    const PlanResult result = make()->plan(hall.problem(), options, Progress());
    gap = std::max(gap, result.report.risk - result.risk_lower_bound.value_or(0.0));
    return result.expanded;
  });
  state.counters["largest_gap"] = gap;
}
void directional(benchmark::State& state) { planWith(state, makeDirectional); }
void tether(benchmark::State& state) { planWith(state, makeTether); }

void tetherWithoutCostToGo(benchmark::State& state) {
  const Hall hall = hallOf(state);
  forGoals(state, hall, [&](CellIndex goal) {
    Traverse traverse(*hall.risk);
    Progress progress;
    Budget budget({}, progress);
    LabelSearch search(*hall.lattice, traverse, 0, {.stacks = true, .goal = goal});
    search.run(budget, "");
    return search.expanded();
  });
}

BENCHMARK(plainDirectional)
    ->Args({24, 0})
    ->Args({40, 0})
    ->Args({100, 0})
    ->Args({24, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(directional)
    ->Args({24, 0})
    ->Args({40, 0})
    ->Args({100, 0})
    ->Args({24, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(tether)->Args({24, 0})->Args({40, 0})->Args({100, 0})->Args({24, 1})->Unit(
    benchmark::kMillisecond);
BENCHMARK(tetherWithoutCostToGo)->Args({24, 0})->Args({40, 0})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tautline::planning
