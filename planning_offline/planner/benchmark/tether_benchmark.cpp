/// `tether` against the plain directional search and against the same states without a cost-to-go,
/// on the same maps and goals; times are of eight goals. Counters: states taken up (mean a goal),
/// and the largest distance of a risk from its lower bound.
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

/// A hall of 10 m × 10 m (2 m high in space) with boxes in it, by seed; the reel in a corner, goals
/// in the other half. Risk per way, so that halls of all resolutions are about the same problem.
struct Hall {
  std::shared_ptr<VoxelMap> map = std::make_shared<VoxelMap>();
  std::unique_ptr<Lattice> lattice;
  std::unique_ptr<RiskModel> risk;
  std::vector<CellIndex> goals;

  Hall(GridShape shape, Connectivity connectivity) {
    std::mt19937 random(5);
    const auto draw = [&random](double lo, double hi) {
      return lo + (hi - lo) * static_cast<double>(random()) / 4294967296.0;
    };
    map->shape = shape;
    map->resolution = 10.0 / shape.nx;
    map->cells.assign(shape.size(), CellState::kFree);
    for (int box = 0; box < 30; ++box) {
      const Eigen::Vector3d lo(draw(0.8, 9.0), draw(-1.0, 1.0), draw(0.8, 9.0));
      const Eigen::Vector3d hi = lo + Eigen::Vector3d(draw(0.3, 1.2), 1.0, draw(0.3, 1.2));
      for (std::size_t i = 0; i < shape.size(); ++i) {
        Eigen::Vector3d p = map->centre(static_cast<CellIndex>(i));
        if (shape.planar()) p.y() = lo.y();
        const bool inside = (p.array() >= lo.array()).all() && (p.array() <= hi.array()).all();
        if (inside) map->cells[i] = CellState::kOccupied;
      }
    }
    std::vector<std::uint8_t> free;
    MapLayer locale{"terrain_stability", {}};
    for (std::size_t i = 0; i < shape.size(); ++i) {
      free.push_back(map->cells[i] == CellState::kFree ? 1 : 0);
      locale.values.push_back(draw(0.0, 1.0));
    }
    map->layers = {locale};
    lattice = std::make_unique<Lattice>(shape, connectivity, free);

    RiskParams params;
    params.mode = RiskMode::kRate;
    params.distance.member.risk = 0.0;
    params.visibility.member.risk = 0.0;
    params.terrain_stability.scale = 0.02;
    risk =
        std::make_unique<RiskModel>(map, MapFields{}, params, makeTautString(*map, map->centre(0)));
    const auto tree = leastRiskTreeReference(*lattice, *risk, 0, Progress());
    while (goals.size() < 8) {
      const auto goal = static_cast<CellIndex>(random() % shape.size());
      const Eigen::Vector3i c = shape.cell(goal);
      const bool far = c.x() + c.z() > shape.nx;
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
                             : Hall({n, n / 5, n}, Connectivity::kVertices);
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

void halls(benchmark::internal::Benchmark* all) {
  all->ArgNames({"cells", "space"})->Unit(benchmark::kMillisecond);
  all->Args({25, 0})->Args({50, 0})->Args({100, 0})->Args({25, 1});
}
BENCHMARK(plainDirectional)->Apply(halls);
BENCHMARK(directional)->Apply(halls);
BENCHMARK(tether)->Apply(halls);
BENCHMARK(tetherWithoutCostToGo)
    ->ArgNames({"cells", "space"})
    ->Args({25, 0})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tautline::planning
