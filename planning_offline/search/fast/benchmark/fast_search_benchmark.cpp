// All least-risk walks of a map, 26-connected: the textbook's heap, a bucket queue and the fast
// search, one after the other in each repetition, so that what disturbs the machine disturbs all.
// Times are of this thread's processor: each of the three uses one thread.

#include <time.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "common/error.h"
#include "planning_offline/field/reference/synthetic_map.h"
#include "planning_offline/map/load_map.h"
#include "planning_offline/search/fast/directional_search.h"
#include "planning_offline/search/fast/reference/plain_search.h"

namespace tautline::planning {
namespace {

enum Law { kConstant, kLinear };

double costOf(double risk) { return -std::log1p(-risk); }

double seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Cells to the nearest cell that is not free, up to `most`, one pass after the other.
std::vector<int> clearanceOf(const Lattice& lattice, int most) {
  const auto free = lattice.freeCells();
  std::vector<int> clearance(free.begin(), free.end());
  for (int reached = 1; reached < most; ++reached) {
    std::vector<int> next = clearance;
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (clearance[i] != reached) continue;
      const auto cell = static_cast<CellIndex>(i);
      bool inside = lattice.moves(cell) == (std::uint32_t{1} << kDirections) - 1;
      for (Direction d = 0; inside && d < kDirections; ++d)
        inside = clearance[static_cast<std::size_t>(lattice.neighbour(cell, d))] >= reached;
      if (inside) next[i] = reached + 1;
    }
    clearance = std::move(next);
  }
  return clearance;
}

struct Problem {
  Lattice lattice;
  CostField field;
  CellIndex start;
};

/// The default risks on a map: distance to obstacles, action length, turns.
Problem problemOf(const VoxelMap& map, Law law) {
  std::vector<std::uint8_t> free;
  for (const CellState state : map.cells) free.push_back(state == CellState::kFree ? 1 : 0);
  Problem problem{Lattice(map.shape, Connectivity::kVertices, std::move(free)), {}, kNoCell};
  for (CellIndex i = 0; problem.start == kNoCell; ++i) {
    if (problem.lattice.moves(i) == (std::uint32_t{1} << kDirections) - 1) problem.start = i;
  }
  CostField& f = problem.field;
  constexpr int kMost = 12;
  for (const int cells : clearanceOf(problem.lattice, kMost))
    f.locale.push_back(costOf(0.06 * (1.0 - static_cast<double>(cells) / kMost)));
  f.locale_in.fill(1.0);
  for (std::size_t d = 0; d < kDirections; ++d) {
    const auto out = static_cast<Direction>(d);
    f.action[d] = costOf(0.0911 * 0.4 * stepLength(out));
    for (std::size_t p = 0; p < kDirections; ++p) {
      const double change = (stepOf(out) - stepOf(static_cast<Direction>(p))).cast<double>().norm();
      f.turn[p][d] = law == kConstant ? (p == d ? 0.0 : costOf(0.05)) : costOf(0.036 * change);
    }
  }
  return problem;
}

void compare(benchmark::State& state, const Problem& problem) {
  const auto units = UnitCosts::make(problem.lattice, problem.field, {});
  TAUTLINE_CHECK(units.has_value());
  double heap = 0.0;
  double bucket = 0.0;
  double fast = 0.0;
  double bytes = 0.0;
  double reached = 0.0;
  for (auto _ : state) {
    const double t0 = seconds();
    DirectionalSearch search(problem.lattice, *units, problem.field.locale, problem.start);
    search.run(Progress());
    const double t1 = seconds();
    const PlainLabels by_bucket =
        bucketSearch(problem.lattice, *units, problem.field.locale, problem.start);
    const double t2 = seconds();
    const PlainLabels by_heap =
        heapSearch(problem.lattice, *units, problem.field.locale, problem.start);
    const double t3 = seconds();
    fast += t1 - t0;
    bucket += t2 - t1;
    heap += t3 - t2;
    bytes = static_cast<double>(search.bytes());
    reached = 0.0;
    for (CellIndex i = 0; i < static_cast<CellIndex>(problem.lattice.shape().size()); ++i) {
      const std::uint32_t least = by_heap.least(i);
      if (least != PlainLabels::kUnreached) reached += 1.0;
      TAUTLINE_CHECK(least == by_bucket.least(i));
      TAUTLINE_CHECK(i == problem.start ||
                     search.least(i).value_or(PlainLabels::kUnreached) == least);
    }
    state.SetIterationTime(t1 - t0);
  }
  const auto free = static_cast<double>(problem.lattice.freeCount());
  const auto runs = static_cast<double>(state.iterations());
  state.counters["free_cells"] = free;
  state.counters["reached"] = reached;
  state.counters["fast_s"] = fast / runs;
  state.counters["bucket_s"] = bucket / runs;
  state.counters["heap_s"] = heap / runs;
  state.counters["x_bucket"] = bucket / fast;
  state.counters["x_heap"] = heap / fast;
  state.counters["bytes_per_free"] = bytes / free;
}

void BM_Rooms(benchmark::State& state) {
  const auto n = static_cast<int>(state.range(0));
  const auto law = static_cast<Law>(state.range(1));
  state.SetLabel(law == kConstant ? "constant turn law" : "linear turn law");
  compare(state, problemOf(roomsMap({n, n, n}, 1), law));
}
BENCHMARK(BM_Rooms)
    ->ArgsProduct({{50, 100}, {kConstant, kLinear}})
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
  const auto law = static_cast<Law>(state.range(0));
  state.SetLabel(law == kConstant ? "constant turn law" : "linear turn law");
  compare(state, problemOf(loadMap(file, {}), law));
}
BENCHMARK(BM_Geb079)
    ->Arg(kConstant)
    ->Arg(kLinear)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace
}  // namespace tautline::planning
