// Fields against their references: both run by turns in the same benchmark, the counter `ratio` is
// the reference's best time over ours. The time shown is ours.

#include <chrono>
#include <limits>
#include <string>

#include <benchmark/benchmark.h>

#include "planning_offline/field/benchmark/benchmark_scene.h"
#include "planning_offline/field/benchmark/distance_reference.h"
#include "planning_offline/field/distance_field.h"
#include "planning_offline/field/free_space.h"
#include "planning_offline/field/isovist.h"
#include "planning_offline/field/line_of_sight.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/passage_width.h"
#include "planning_offline/field/reach.h"
#include "planning_offline/field/reference/field_reference.h"
#include "planning_offline/simd.h"

namespace tautline::planning {
namespace {

const Progress kQuiet;

template <class Work>
double secondsOf(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Best of the times that were measured.
class Best {
 public:
  double add(double seconds) {
    seconds_ = std::min(seconds_, seconds);
    return seconds;
  }
  [[nodiscard]] double nanosecondsOf(std::size_t items) const {
    return 1e9 * seconds_ / static_cast<double>(items);
  }

 private:
  double seconds_{std::numeric_limits<double>::infinity()};
};

void showRatio(benchmark::State& state, const char* item, double reference_ns, double ours_ns) {
  state.counters[std::string("ns_per_") + item] = ours_ns;
  state.counters["reference_ns"] = reference_ns;
  state.counters["ratio"] = reference_ns / ours_ns;
}

const BenchmarkScene* sceneOf(benchmark::State& state, std::int64_t number) {
  const BenchmarkScene* scene = number == 0 ? &roomsScene() : buildingScene();
  if (scene == nullptr) state.SkipWithError("geb079.bt is not in TAUTLINE_DATA/octomap");
  return scene;
}

// ---- against DynamicEDT3D; reach in cells for both

void BM_Distance(benchmark::State& state) {
  const BenchmarkScene* scene = sceneOf(state, state.range(0));
  if (scene == nullptr) return;
  const VoxelMap& map = scene->map;
  const auto reach = static_cast<int>(state.range(1));
  const SimdLimit limit(static_cast<int>(state.range(3)));
  const std::vector<std::uint8_t> obstacles = obstacleCells(map, false);
  const DistanceOptions options{.resolution = map.resolution,
                                .cap = reach * map.resolution,
                                .threads = static_cast<int>(state.range(2))};
  Best ours;
  Best reference;
  for (auto _ : state) {
    reference.add(dynamicEdtSeconds(map.shape, obstacles, reach));
    state.SetIterationTime(ours.add(secondsOf([&] {
      benchmark::DoNotOptimize(distanceField(map.shape, obstacles, options, kQuiet, {"distance"}));
    })));
  }
  showRatio(state, "voxel", reference.nanosecondsOf(map.shape.size()),
            ours.nanosecondsOf(map.shape.size()));
  state.SetLabel(map.name);
}
BENCHMARK(BM_Distance)
    ->ArgNames({"map", "reach", "threads", "bytes"})
    ->Args({0, 20, 1, 64})
    ->Args({0, 20, 2, 64})
    ->Args({0, 20, 2, 32})
    ->Args({0, 20, 2, 16})
    ->Args({0, 1000, 2, 64})
    ->Args({1, 20, 2, 64})
    ->Args({1, 1000, 2, 64})
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

// ---- against the scalar voxel walk, which looks at every 97th free cell only

void BM_Isovist(benchmark::State& state) {
  constexpr int kEvery = 97;
  const BenchmarkScene* scene = sceneOf(state, state.range(0));
  if (scene == nullptr) return;
  const VoxelMap& map = scene->map;
  const SimdLimit limit(static_cast<int>(state.range(2)));
  const std::vector<std::uint8_t> obstacles = obstacleCells(map, true);
  const std::size_t free =
      static_cast<std::size_t>(std::count(obstacles.begin(), obstacles.end(), std::uint8_t{0}));
  const IsovistOptions options{.resolution = map.resolution,
                               .directions = 128,
                               .cap = 10.0,
                               .threads = static_cast<int>(state.range(1))};
  Best ours;
  Best reference;
  for (auto _ : state) {
    reference.add(secondsOf([&] {
      benchmark::DoNotOptimize(isovistReference(map.shape, obstacles, options, kEvery));
    }));
    state.SetIterationTime(ours.add(secondsOf([&] {
      benchmark::DoNotOptimize(isovistField(map.shape, obstacles, options, kQuiet, {"isovist"}));
    })));
  }
  showRatio(state, "free_voxel", reference.nanosecondsOf(free / kEvery), ours.nanosecondsOf(free));
  state.SetLabel(map.name);
}
BENCHMARK(BM_Isovist)
    ->ArgNames({"map", "threads", "bytes"})
    ->Args({0, 1, 64})
    ->Args({0, 2, 64})
    ->Args({0, 2, 32})
    ->Args({0, 2, 16})
    ->Args({1, 2, 64})
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

// ---- against octomap::castRay on the same pairs of free cells; unknown is free for both

void BM_LineOfSight(benchmark::State& state) {
  const BenchmarkScene* scene = sceneOf(state, state.range(0));
  if (scene == nullptr) return;
  const VoxelMap& map = scene->map;
  const std::vector<std::uint8_t> blocked = obstacleCells(map, false);
  const auto pairs = randomPairs(map, 20000, 1);
  std::vector<std::uint8_t> ray_hits(pairs.size());
  std::vector<std::uint8_t> seen(pairs.size());
  const auto pointOf = [&map](CellIndex i) {
    const Eigen::Vector3f p = map.centre(i).cast<float>();
    return octomap::point3d(p.x(), p.y(), p.z());
  };
  const auto centreOf = [&map](CellIndex i) {
    return Eigen::Vector3d(map.shape.cell(i).cast<double>().array() + 0.5);
  };
  Best ours;
  Best reference;
  for (auto _ : state) {
    reference.add(secondsOf([&] {
      for (std::size_t n = 0; n < pairs.size(); ++n) {
        const octomap::point3d from = pointOf(pairs[n].first);
        const octomap::point3d way = pointOf(pairs[n].second) - from;
        octomap::point3d end;
        ray_hits[n] = scene->tree->castRay(from, way, end, true, way.norm()) ? 1 : 0;
      }
    }));
    state.SetIterationTime(ours.add(secondsOf([&] {
      for (std::size_t n = 0; n < pairs.size(); ++n) {
        seen[n] =
            lineOfSight(map.shape, blocked, centreOf(pairs[n].first), centreOf(pairs[n].second))
                ? 1
                : 0;
      }
    })));
  }
  std::size_t differing = 0;  // castRay steps in floats and cuts some corners
  for (std::size_t n = 0; n < pairs.size(); ++n) differing += seen[n] == ray_hits[n] ? 1U : 0U;
  state.counters["differing_percent"] =
      100.0 * static_cast<double>(differing) / static_cast<double>(pairs.size());
  showRatio(state, "line", reference.nanosecondsOf(pairs.size()), ours.nanosecondsOf(pairs.size()));
  state.SetLabel(map.name);
}
BENCHMARK(BM_LineOfSight)
    ->ArgNames({"map"})
    ->Arg(0)
    ->Arg(1)
    ->UseManualTime()
    ->Iterations(5)
    ->Unit(benchmark::kMillisecond);

// ---- against walking both ways from every cell

void BM_PassageWidth(benchmark::State& state) {
  const BenchmarkScene* scene = sceneOf(state, state.range(0));
  if (scene == nullptr) return;
  const VoxelMap& map = scene->map;
  const std::vector<std::uint8_t> obstacles = obstacleCells(map, true);
  const WidthOptions options{.resolution = map.resolution,
                             .threads = static_cast<int>(state.range(1))};
  Best ours;
  Best reference;
  for (auto _ : state) {
    reference.add(secondsOf(
        [&] { benchmark::DoNotOptimize(widthReference(map.shape, obstacles, options)); }));
    state.SetIterationTime(ours.add(secondsOf([&] {
      benchmark::DoNotOptimize(widthField(map.shape, obstacles, options, kQuiet, {"width"}));
    })));
  }
  showRatio(state, "voxel", reference.nanosecondsOf(map.shape.size()),
            ours.nanosecondsOf(map.shape.size()));
  state.SetLabel(map.name);
}
BENCHMARK(BM_PassageWidth)
    ->ArgNames({"map", "threads"})
    ->Args({0, 2})
    ->Args({1, 2})
    ->UseManualTime()
    ->Iterations(3)
    ->Unit(benchmark::kMillisecond);

// ---- on its own; wanted: 0.3 s for a million voxels

void BM_Reach(benchmark::State& state) {
  const BenchmarkScene* scene = sceneOf(state, state.range(0));
  if (scene == nullptr) return;
  const VoxelMap& map = scene->map;
  const std::vector<std::uint8_t> free = freeSpace(map, {}, kQuiet);
  const Eigen::Vector3d reel = map.centre(randomPairs(map, 1, 7)[0].first);
  const ReachOptions options{.threads = static_cast<int>(state.range(1))};
  ReachMap reach;
  for (auto _ : state) reach = computeReach(map, free, reel, options, kQuiet);
  state.counters["free"] = static_cast<double>(reach.free);
  state.counters["straight"] = static_cast<double>(reach.straight_count);
  state.counters["with_contacts"] = static_cast<double>(reach.with_contacts_count);
  state.SetLabel(map.name);
}
BENCHMARK(BM_Reach)
    ->ArgNames({"map", "threads"})
    ->Args({0, 2})
    ->Args({1, 2})
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tautline::planning
