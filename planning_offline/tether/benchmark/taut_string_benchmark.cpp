// Time of one step of the taut strings on random maps, and, by turns with it, of one look at every
// convex edge of the map against the triangle of that step: what a string without an index would
// do at least once a step.

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "planning_offline/tether/convex_edges.h"
#include "planning_offline/tether/shrunk_solid.h"
#include "planning_offline/tether/sliding_string.h"
#include "planning_offline/tether/taut_string.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

using Clock = std::chrono::steady_clock;

double microseconds(Clock::time_point since) {
  return std::chrono::duration<double, std::micro>(Clock::now() - since).count();
}

/// A unit edge: across its axis, and where it begins along it. In cells.
struct UnitEdge {
  Eigen::Vector2d at;
  int w;
  int axis;
};

std::vector<UnitEdge> allEdges(const VoxelMap& map) {
  std::vector<UnitEdge> list;
  for (int axis = 0; axis < 3; ++axis) {
    if (map.shape.planar() && axis != 1) continue;
    const ConvexEdges edges(map, axis);
    for (int w = 0; w < edges.sizeW(); ++w) {
      for (int v = 0; v <= edges.sizeV(); ++v) {
        for (int u = 0; u <= edges.sizeU(); ++u) {
          if (edges.quadrants(u, v, w) != 0) list.push_back({Eigen::Vector2d(u, v), w, axis});
        }
      }
    }
  }
  return list;
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Edges that go through the triangle.
int hits(const std::vector<UnitEdge>& edges, const Eigen::Vector3d& c, const Eigen::Vector3d& p,
         const Eigen::Vector3d& q) {
  int count = 0;
  for (const UnitEdge& edge : edges) {
    const int u = axisU(edge.axis);
    const int v = axisV(edge.axis);
    const Eigen::Vector2d to_p(p[u] - c[u], p[v] - c[v]);
    const Eigen::Vector2d to_q(q[u] - c[u], q[v] - c[v]);
    const Eigen::Vector2d r = edge.at - Eigen::Vector2d(c[u], c[v]);
    const double area = cross(to_p, to_q);
    const double alpha = cross(r, to_q);
    const double beta = cross(to_p, r);
    if (alpha * area <= 0.0 || beta * area < 0.0 || (alpha + beta - area) * area >= 0.0) continue;
    const double w =
        c[edge.axis] +
        (alpha * (p[edge.axis] - c[edge.axis]) + beta * (q[edge.axis] - c[edge.axis])) / area;
    count += w >= edge.w && w <= edge.w + 1 ? 1 : 0;
  }
  return count;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The string of searches and missions: exact in the plane, pinned in space.
class InternedFlight {
 public:
  InternedFlight(const VoxelMap& map, const Eigen::Vector3d& start)
      : string_(makeTautString(map, start)), at_(start) {}
  void moveTo(const Eigen::Vector3d& to) {
    stack_ = string_->move(stack_, at_, to);
    at_ = to;
  }
  [[nodiscard]] Eigen::Vector3d anchor() const { return string_->anchor(stack_); }
  [[nodiscard]] int contacts() const { return string_->contactCount(stack_); }
  [[nodiscard]] double length() const { return string_->length(stack_, at_); }
  [[nodiscard]] std::int64_t unresolved() const { return string_->unresolvedMoves(); }

 private:
  std::unique_ptr<TautString> string_;
  StackId stack_{kStraight};
  Eigen::Vector3d at_;
};

class SlidingFlight {
 public:
  SlidingFlight(const VoxelMap& map, const Eigen::Vector3d& start) : string_(map, start) {}
  void moveTo(const Eigen::Vector3d& to) { string_.moveTo(to); }
  [[nodiscard]] Eigen::Vector3d anchor() const {
    const std::vector<Eigen::Vector3d> contacts = string_.contacts();
    return contacts.empty() ? string_.reel() : contacts.back();
  }
  [[nodiscard]] int contacts() const { return static_cast<int>(string_.contacts().size()); }
  [[nodiscard]] double length() const { return string_.length(); }
  [[nodiscard]] std::int64_t unresolved() const { return string_.unresolvedMoves(); }

 private:
  SlidingString string_;
};

template <class Flight>
void walkAll(benchmark::State& state, const GridShape& shape) {
  walks::Random random(1);
  const VoxelMap map = walks::clutteredMap(shape, static_cast<int>(state.range(1)), random);
  const Lattice lattice = walks::freeLattice(map, Connectivity::kVertices);
  const std::vector<UnitEdge> edges = allEdges(map);
  std::vector<double> steps;
  std::vector<double> scans;
  double steps_sum = 0.0;
  double contacts = 0.0;
  double length = 0.0;
  std::int64_t unresolved = 0;
  for (auto _ : state) {
    const std::vector<Eigen::Vector3d> walk =
        walks::centres(map, walks::randomWalk(lattice, 400, random));
    Flight flight(map, walk.front());
    for (std::size_t i = 1; i < walk.size(); ++i) {
      const Eigen::Vector3d anchor = flight.anchor();
      const Clock::time_point step = Clock::now();
      flight.moveTo(walk[i]);
      steps.push_back(microseconds(step));
      steps_sum += steps.back();
      contacts += flight.contacts();
      length += flight.length() / map.resolution;
      if (i % 16 != 0) continue;
      const auto cells = [&map](const Eigen::Vector3d& p) {
        return Eigen::Vector3d((p - map.origin) / map.resolution);
      };
      const Clock::time_point scan = Clock::now();
      benchmark::DoNotOptimize(hits(edges, cells(anchor), cells(walk[i - 1]), cells(walk[i])));
      scans.push_back(microseconds(scan));
    }
    unresolved += flight.unresolved();
  }
  const auto count = static_cast<double>(steps.size());
  const double step = median(steps);
  const double scan = median(scans);
  state.counters["step_median_us"] = step;
  state.counters["step_mean_us"] = steps_sum / count;
  state.counters["step_p99_us"] = [&steps] {
    const auto at = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() * 99 / 100);
    std::nth_element(steps.begin(), at, steps.end());
    return *at;
  }();
  state.counters["scan_median_us"] = scan;
  state.counters["scan_per_step"] = scan / step;
  state.counters["edges"] = static_cast<double>(edges.size());
  state.counters["contacts"] = contacts / count;
  state.counters["length_cells"] = length / count;
  state.counters["unresolved"] = static_cast<double>(unresolved);
}

void BM_PlanarStep(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  walkAll<InternedFlight>(state, {side, 1, side});
}
BENCHMARK(BM_PlanarStep)
    ->Args({100, 8})
    ->Args({400, 50})
    ->Iterations(40)
    ->Unit(benchmark::kMillisecond);

void BM_PinnedStep(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  walkAll<InternedFlight>(state, {side, side, side});
}
BENCHMARK(BM_PinnedStep)
    ->Args({40, 8})
    ->Args({100, 50})
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);

void BM_SlidingStep(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  walkAll<SlidingFlight>(state, {side, side, side});
}
BENCHMARK(BM_SlidingStep)
    ->Args({40, 8})
    ->Args({100, 50})
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond);

/// The cheap test alone: strings of one step between cells anywhere on the map.
void BM_NearField(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  walks::Random random(2);
  const VoxelMap map =
      walks::clutteredMap({side, side, side}, static_cast<int>(state.range(1)), random);
  const ShrunkSolid solid(map);
  std::uniform_real_distribution<double> anywhere(0.0, side);
  const auto point = [&] {
    return Eigen::Vector3d(anywhere(random), anywhere(random), anywhere(random));
  };
  struct Sweep {
    Eigen::Vector3d c, p, q;
  };
  std::vector<Sweep> sweeps;
  for (int n = 0; n < 1000; ++n) {
    const Eigen::Vector3d p = point();
    sweeps.push_back({point(), p, p + Eigen::Vector3d(1.0, 0.0, -1.0)});
  }
  double near = 0.0;
  double length = 0.0;
  for (auto _ : state) {
    near = length = 0.0;
    for (const Sweep& sweep : sweeps) {
      length += (sweep.p - sweep.c).norm();
      for (const auto& [low, high] : solid.field().near(sweep.c, sweep.p, sweep.q).edges) {
        near += (high - low) * (sweep.p - sweep.c).norm();
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(sweeps.size()));
  state.counters["length_cells"] = length / static_cast<double>(sweeps.size());
  state.counters["near_share"] = near / length;
}
BENCHMARK(BM_NearField)
    ->Args({40, 8})
    ->Args({100, 50})
    ->Args({100, 5000})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace tautline::planning
