#include "planning_offline/planner/prm/benchmark/clearance_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "common/error.h"
#include "planning_offline/field/free_space.h"
#include "planning_offline/field/line_of_sight.h"
#include "planning_offline/search/least_risk_tree.h"

namespace tautline::planning {
namespace {

/// Clearance up to 1.5 m counts, and a little length, so that no way is free of charge.
RiskParams clearanceParams() {
  RiskParams params;
  params.mode = RiskMode::kRate;
  params.distance.member = {0.2, 0.1, 1.5};
  params.visibility.member.risk = 0.0;
  params.action_length.per_metre = 0.02;
  params.turn.risk = 0.0;
  params.tether_length.per_metre = 0.0;
  params.contacts.each = 0.0;
  return params;
}

}  // namespace

ClearanceProblem::ClearanceProblem(VoxelMap map) {
  const Progress progress;
  const RiskParams params = clearanceParams();
  FieldRequest request;
  request.distance = true;
  request.distance_cap = params.distance.member.none;
  MapFields fields = computeFields(map, request, progress);
  lattice_ =
      std::make_unique<Lattice>(map.shape, Connectivity::kVertices, freeSpace(map, {}, progress));
  const double resolution = map.resolution;
  model_ = std::make_unique<RiskModel>(std::make_shared<const VoxelMap>(std::move(map)),
                                       std::move(fields), params, nullptr);
  const CostField& costs = model_->costs();
  const double per_cell = costs.action[static_cast<std::size_t>(directionOf({1, 0, 0}))];
  for (std::size_t i = 0; i < costs.locale.size(); ++i) {
    const bool free = lattice_->free(static_cast<CellIndex>(i));
    blocked_.push_back(free ? 0 : 1);
    rate_.push_back(
        static_cast<float>(per_cell + costs.locale[i] * resolution / params.reference_step));
  }
  choosePlaces();
}

/// The start well away from obstacles, the goal the farthest of some such places that it reaches.
void ClearanceProblem::choosePlaces() {
  std::mt19937 random(1);
  const auto cells = static_cast<std::uint32_t>(lattice_->shape().size());
  std::vector<CellIndex> places;
  while (places.size() < 40) {
    const auto cell = static_cast<CellIndex>(random() % cells);
    const auto& distance = model_->fields().distance;
    if (lattice_->free(cell) && distance[static_cast<std::size_t>(cell)] > 0.3F) {
      places.push_back(cell);
    }
  }
  std::size_t most = 0;
  for (const CellIndex from : {places[0], places[1], places[2]}) {
    const auto tree = leastRiskTree(*lattice_, *model_, from, 0, Progress());
    std::vector<CellIndex> reached;
    for (const CellIndex to : places) {
      if (std::isfinite(tree->costTo(to))) reached.push_back(to);
    }
    if (reached.size() <= most) continue;
    most = reached.size();
    start_ = centre(from);
    goal_ = centre(*std::max_element(reached.begin(), reached.end(), [&](CellIndex a, CellIndex b) {
      return tree->costTo(a) < tree->costTo(b);
    }));
  }
  TAUTLINE_CHECK(most > 1);
}

Eigen::Vector3d ClearanceProblem::centre(CellIndex i) const {
  return lattice_->shape().cell(i).cast<double>().array() + 0.5;
}

CellIndex ClearanceProblem::cellAt(const Eigen::Vector3d& p) const {
  return lattice_->shape().index(p.array().floor().cast<int>());
}

bool ClearanceProblem::free(const Eigen::Vector3d& p) const {
  const Eigen::Vector3i cell = p.array().floor().cast<int>();
  return lattice_->shape().contains(cell) && lattice_->free(lattice_->shape().index(cell));
}

bool ClearanceProblem::sees(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
  return lineOfSight(lattice_->shape(), blocked_, a, b);
}

double ClearanceProblem::cost(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
  const Eigen::Vector3d way = b - a;
  const double length = way.norm();
  const int pieces = std::max(1, static_cast<int>(std::ceil(2.0 * length)));
  double sum = 0.0;
  for (int k = 0; k < pieces; ++k) {
    const Eigen::Vector3d p = a + way * ((k + 0.5) / pieces);
    sum += static_cast<double>(rate_[static_cast<std::size_t>(cellAt(p))]);
  }
  return sum * length / pieces;
}

double ClearanceProblem::cost(const CellPoints& path) const {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += cost(path[i - 1], path[i]);
  return sum;
}

CellPoints ClearanceProblem::solve() const {
  const auto tree = leastRiskTree(*lattice_, *model_, cellAt(start_), 0, Progress());
  CellPoints path;
  for (const CellIndex cell : tree->pathTo(cellAt(goal_))) path.push_back(centre(cell));
  return shortcut(path);
}

/// The cheapest polygon whose corners are some of the path's points, in order.
CellPoints ClearanceProblem::shortcut(const CellPoints& path) const {
  std::vector<double> best(path.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> before(path.size(), 0);
  best.front() = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    for (std::size_t j = i; j-- > 0;) {
      if (!sees(path[j], path[i])) {
        if (j + 1 < i) break;  // round a corner: farther ones hardly see it either
        continue;
      }
      const double there = best[j] + cost(path[j], path[i]);
      if (there < best[i]) {
        best[i] = there;
        before[i] = j;
      }
    }
  }
  CellPoints shorter{path.back()};
  for (std::size_t i = path.size() - 1; i > 0; i = before[i]) shorter.push_back(path[before[i]]);
  std::reverse(shorter.begin(), shorter.end());
  return shorter;
}

}  // namespace tautline::planning
