// What the two-stage planner loses against `utility`, how often that one proves its answer, and how
// far its bound is off where it does not (docs/utility.md).
//
//   planning_utility_benchmark

#include <algorithm>
#include <cstdint>

#include <benchmark/benchmark.h>

#include "planning_offline/planner/makers.h"
#include "planning_offline/search/test/small_world.h"

namespace tautline::planning {
namespace {

enum Rewards { kDense, kSparse };
constexpr std::int64_t kLabels = 200'000;

struct World {
  testing::SmallWorld small;
  std::vector<double> reward;
};

/// n × n cells, a fifth of them obstacles; rewards in all cells or in a tenth of them.
World makeWorld(int n, Connectivity connectivity, Rewards rewards, std::uint32_t seed) {
  World world{testing::emptyWorld({n, 1, n}, connectivity), {}};
  testing::Random random(seed);
  VoxelMap& map = *world.small.map;
  map.layers = {{"terrain_stability", {}}};
  for (CellState& state : map.cells) {
    state = random.uniform(0.0, 1.0) < 0.2 ? CellState::kOccupied : CellState::kFree;
    map.layers[0].values.push_back(random.uniform(0.0, 0.05));
    const bool rewarded = rewards == kDense || random.uniform(0.0, 1.0) < 0.1;
    world.reward.push_back(rewarded ? random.uniform(0.0, 1.0) : 0.0);
  }
  world.small.start = static_cast<CellIndex>(random.below(n * n));
  const auto start = static_cast<std::size_t>(world.small.start);
  map.cells[start] = CellState::kFree;
  world.reward[start] = 0.05;
  RiskParams& params = world.small.params;
  params.terrain_stability.scale = 1.0;
  params.action_length.per_metre = 0.04;
  params.turn.law = TurnLaw::kLinear;
  params.turn.risk = 0.05;
  world.small.build();
  return world;
}

void maps(benchmark::State& state, int n, Connectivity connectivity, Rewards rewards) {
  PlanOptions options;
  options.label_limit = kLabels;
  double share = 0.0;
  double least = 1.0;
  double gap = 0.0;
  double proven = 0.0;
  double loses = 0.0;
  double risk = 0.0;
  std::uint32_t seed = 0;
  for (auto _ : state) {
    const World world = makeWorld(n, connectivity, rewards, seed++);
    const PlanProblem problem{world.small.lattice.get(), world.small.risk.get(), world.reward,
                              world.small.start};
    const PlanResult best = makeUtility()->plan(problem, options, Progress());
    state.PauseTiming();
    const PlanResult two_stage = makeUtilityTwoStage()->plan(problem, options, Progress());
    const double part = two_stage.utility / best.utility;
    share += part;
    least = std::min(least, part);
    loses += part < 1.0 - 1e-9 ? 1.0 : 0.0;
    proven += best.status == PlanStatus::kOptimal ? 1.0 : 0.0;
    gap += 1.0 - best.utility / *best.utility_upper_bound;
    risk += best.report.risk;
    state.ResumeTiming();
  }
  const auto mean = benchmark::Counter::kAvgIterations;
  state.counters["two_stage"] = benchmark::Counter(share, mean);
  state.counters["worst"] = least;
  state.counters["loses"] = benchmark::Counter(loses, mean);
  state.counters["proven"] = benchmark::Counter(proven, mean);
  state.counters["gap"] = benchmark::Counter(gap, mean);
  state.counters["risk"] = benchmark::Counter(risk, mean);
}

#define TAUTLINE_MAPS(n, connectivity, rewards, count)                                         \
  BENCHMARK_CAPTURE(maps, n##x##n##_##connectivity##_##rewards, n, Connectivity::connectivity, \
                    rewards)                                                                   \
      ->Iterations(count)                                                                      \
      ->Unit(benchmark::kMillisecond)

TAUTLINE_MAPS(3, kFaces, kDense, 200);
TAUTLINE_MAPS(4, kFaces, kDense, 200);
TAUTLINE_MAPS(5, kFaces, kDense, 100);
TAUTLINE_MAPS(5, kVertices, kDense, 30);
TAUTLINE_MAPS(8, kVertices, kDense, 10);
TAUTLINE_MAPS(8, kVertices, kSparse, 10);
TAUTLINE_MAPS(20, kVertices, kSparse, 5);

}  // namespace
}  // namespace tautline::planning
