// Contacts and tether length of the least-risk paths to all cells: the walk over their tree, and by
// turns with it the string moved along the whole path of each goal. The latter is done for a sample
// of the goals, by seed, and its time extrapolated to all of them. Times are of this thread's
// processor: both use one thread.

#include <time.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "common/error.h"
#include "planning_offline/field/map_fields.h"
#include "planning_offline/field/reference/synthetic_map.h"
#include "planning_offline/map/load_map.h"
#include "planning_offline/search/path_tethers.h"

namespace tautline::planning {
namespace {

double seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Problem {
  std::shared_ptr<const VoxelMap> map;
  std::unique_ptr<Lattice> lattice;
  std::unique_ptr<RiskModel> risk;
  std::unique_ptr<LeastRiskTree> tree;
};

/// Least-risk paths by the default risks in rate mode, 26-connected; the start is the free cell
/// nearest to `start`, and the reel stands there.
Problem problemOf(VoxelMap map, const Eigen::Vector3d& start) {
  Problem problem;
  std::vector<std::uint8_t> free;
  for (const CellState state : map.cells) free.push_back(state == CellState::kFree ? 1 : 0);
  problem.lattice = std::make_unique<Lattice>(map.shape, Connectivity::kVertices, std::move(free));
  CellIndex nearest = kNoCell;
  for (CellIndex i = 0; i < static_cast<CellIndex>(map.shape.size()); ++i) {
    if (!problem.lattice->free(i)) continue;
    if (nearest == kNoCell || (map.centre(i) - start).norm() < (map.centre(nearest) - start).norm())
      nearest = i;
  }
  map.reel = map.centre(nearest);
  problem.map = std::make_shared<const VoxelMap>(std::move(map));
  RiskParams params;
  params.mode = RiskMode::kRate;
  const Progress quiet;
  MapFields fields = computeFields(*problem.map, neededFields(params, *problem.map), quiet);
  problem.risk = std::make_unique<RiskModel>(problem.map, std::move(fields), params,
                                             makeTautString(*problem.map, *problem.map->reel));
  problem.tree = leastRiskTree(*problem.lattice, *problem.risk, nearest, 1, quiet);
  return problem;
}

/// Length of the string at the end of one path, by moving it along all of it.
double replay(const Problem& problem, TautString& string, CellIndex goal, std::size_t& steps) {
  Eigen::Vector3d position = string.reel();
  StackId stack = kStraight;
  for (const CellIndex cell : problem.tree->pathTo(goal)) {
    const Eigen::Vector3d next = problem.map->centre(cell);
    stack = string.move(stack, position, next);
    position = next;
    ++steps;
  }
  return string.length(stack, position);
}

void compare(benchmark::State& state, const Problem& problem) {
  std::vector<CellIndex> goals;
  for (CellIndex i = 0; i < static_cast<CellIndex>(problem.map->shape.size()); ++i) {
    if (problem.tree->lastOf(i)) goals.push_back(i);
  }
  std::mt19937 random(1);
  std::uniform_int_distribution<std::size_t> pick(0, goals.size() - 1);
  constexpr std::size_t kSample = 5000;
  std::vector<CellIndex> sample;
  while (sample.size() < kSample) sample.push_back(goals[pick(random)]);

  double walk = 0.0;
  double naive = 0.0;
  std::size_t steps = 0;
  PathTethers all;
  for (auto _ : state) {
    // Each with a string that knows no stacks yet.
    const auto string = makeTautString(*problem.map, *problem.map->reel);
    const double t0 = seconds();
    for (const CellIndex goal : sample)
      benchmark::DoNotOptimize(replay(problem, *string, goal, steps));
    const double t1 = seconds();
    RiskModel risk(problem.map, problem.risk->fields(), problem.risk->params(),
                   makeTautString(*problem.map, *problem.map->reel));
    const double t2 = seconds();
    all = tethersOfPaths(*problem.lattice, risk, *problem.tree, Progress());
    const double t3 = seconds();
    naive += (t1 - t0) * static_cast<double>(goals.size()) / kSample;
    walk += t3 - t2;
    state.SetIterationTime(t3 - t2);
    std::size_t ignored = 0;
    for (std::size_t i = 0; i < kSample; i += 100) {
      const double length = replay(problem, *risk.string(), sample[i], ignored);
      TAUTLINE_CHECK(all.length[static_cast<std::size_t>(sample[i])] == length);
    }
  }
  double contacts = 0.0;
  for (const CellIndex goal : goals) contacts += all.contacts[static_cast<std::size_t>(goal)];
  const auto runs = static_cast<double>(state.iterations());
  const auto count = static_cast<double>(goals.size());
  state.counters["goals"] = count;
  state.counters["moves"] = static_cast<double>(all.moves);
  state.counters["steps_a_path"] = static_cast<double>(steps) / (runs * kSample);
  state.counters["contacts_a_path"] = contacts / count;
  state.counters["walk_s"] = walk / runs;
  state.counters["replay_s"] = naive / runs;
  state.counters["ratio"] = naive / walk;
  state.counters["us_per_move"] = 1e6 * walk / (runs * static_cast<double>(all.moves));
  state.counters["bytes_a_goal"] = static_cast<double>(all.bytes) / count;
}

/// The floor plan at half the height.
VoxelMap planOf(const VoxelMap& map) {
  VoxelMap plan = map;
  plan.shape.ny = 1;
  plan.cells.clear();
  for (int z = 0; z < map.shape.nz; ++z) {
    for (int x = 0; x < map.shape.nx; ++x) {
      const CellIndex cell = map.shape.index({x, map.shape.ny / 2, z});
      plan.cells.push_back(map.cells[static_cast<std::size_t>(cell)]);
    }
  }
  return plan;
}

void BM_Rooms(benchmark::State& state) {
  const auto n = static_cast<int>(state.range(0));
  const bool planar = state.range(1) != 0;
  VoxelMap map = roomsMap({n, planar ? 12 : n, n}, 1);
  if (planar) map = planOf(map);
  compare(state, problemOf(map, map.origin + 0.12 * map.resolution * Eigen::Vector3d(n, n, n)));
}
BENCHMARK(BM_Rooms)
    ->ArgNames({"side", "planar"})
    ->Args({100, 0})
    ->Args({400, 1})
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

void BM_Geb079(benchmark::State& state) {
  const char* data = std::getenv("TAUTLINE_DATA");
  const std::filesystem::path folder =
      data != nullptr ? data : std::filesystem::path(TAUTLINE_SOURCE_DIR) / "../shared/data";
  const std::filesystem::path file = folder / "octomap" / "geb079.bt";
  if (!std::filesystem::exists(file)) {
    state.SkipWithError("no octomap/geb079.bt: set TAUTLINE_DATA");
    return;
  }
  compare(state, problemOf(loadMap(file, {}), {1.0, 1.0, 1.0}));
}
BENCHMARK(BM_Geb079)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace tautline::planning
