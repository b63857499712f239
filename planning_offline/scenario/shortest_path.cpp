#include "planning_offline/scenario/shortest_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>

#include "common/error.h"

namespace tautline::planning {
namespace {

constexpr std::size_t kAskEvery = 4096;  // expansions between two looks at `cancelled`

std::size_t at(CellIndex i) { return static_cast<std::size_t>(i); }

/// On the heap of open cells: nearest bound first, then farthest from the start, then by index.
struct Open {
  double bound{0.0};
  double cost{0.0};
  CellIndex cell{kNoCell};

  bool operator<(const Open& other) const {  // the greatest is on top
    if (bound != other.bound) return bound > other.bound;
    if (cost != other.cost) return cost < other.cost;
    return cell > other.cell;
  }
};

}  // namespace

double octileDistance(const Eigen::Vector3i& a, const Eigen::Vector3i& b,
                      Connectivity connectivity) noexcept {
  Eigen::Vector3i d = (a - b).cwiseAbs();
  std::sort(d.begin(), d.end());
  const int sum = d.sum();
  switch (connectivity) {
    case Connectivity::kFaces:
      return sum;
    case Connectivity::kEdges: {
      const int edges = std::min(sum / 2, sum - d[2]);  // each shortens two different axes
      return std::sqrt(2.0) * edges + (sum - 2 * edges);
    }
    case Connectivity::kVertices:
      break;
  }
  return std::sqrt(3.0) * d[0] + std::sqrt(2.0) * (d[1] - d[0]) + (d[2] - d[1]);
}

ShortestPath::ShortestPath(const Lattice& lattice)
    : lattice_(lattice), labels_(lattice.shape().size()) {}

std::optional<double> ShortestPath::length(CellIndex start, CellIndex goal,
                                           const Progress& progress) {
  TAUTLINE_CHECK(start >= 0 && at(start) < labels_.size());
  TAUTLINE_CHECK(goal >= 0 && at(goal) < labels_.size());
  if (!lattice_.free(start) || !lattice_.free(goal)) return std::nullopt;
  ++search_;
  const GridShape& shape = lattice_.shape();
  const Eigen::Vector3i goal_cell = shape.cell(goal);
  const auto bound = [&](CellIndex i) {
    return octileDistance(shape.cell(i), goal_cell, lattice_.connectivity());
  };
  std::priority_queue<Open> open;
  labels_[at(start)] = {0.0, search_, kNoCell, false};
  open.push({bound(start), 0.0, start});
  for (std::size_t expanded = 0; !open.empty();) {
    const CellIndex cell = open.top().cell;
    open.pop();
    Label& label = labels_[at(cell)];
    if (label.settled) continue;
    label.settled = true;
    if (cell == goal) return countedLength(start, goal);
    if (++expanded % kAskEvery == 0 && progress.cancelled()) return std::nullopt;
    for (const Direction d : lattice_.directions()) {
      if (((lattice_.moves(cell) >> d) & 1U) == 0) continue;
      const CellIndex next = lattice_.neighbour(cell, d);
      const double cost = label.cost + stepLength(d);
      Label& other = labels_[at(next)];
      if (other.search == search_ && (other.settled || other.cost <= cost)) continue;
      other = {cost, search_, cell, false};
      open.push({cost + bound(next), cost, next});
    }
  }
  return std::nullopt;
}

double ShortestPath::countedLength(CellIndex start, CellIndex goal) const {
  std::array<int, 3> steps{};  // over faces, edges, vertices
  for (CellIndex cell = goal; cell != start; cell = labels_[at(cell)].from) {
    const Eigen::Vector3i step =
        lattice_.shape().cell(cell) - lattice_.shape().cell(labels_[at(cell)].from);
    ++steps[static_cast<std::size_t>(step.cwiseAbs().sum() - 1)];
  }
  return steps[0] + std::sqrt(2.0) * steps[1] + std::sqrt(3.0) * steps[2];
}

}  // namespace tautline::planning
