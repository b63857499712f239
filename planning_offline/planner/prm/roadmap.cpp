#include "planning_offline/planner/prm/roadmap.h"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/PlannerData.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ValidStateSampler.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <queue>
#include <random>
#include <utility>

#include <Eigen/Core>

#include "planning_offline/field/line_of_sight.h"

namespace tautline::planning {
namespace {

namespace ob = ompl::base;
using State = ob::RealVectorStateSpace::StateType;

constexpr std::size_t kBatch = 500;  // milestones between two looks at what is connected

/// OMPL's log is for its developers, not for who uses a planner.
class QuietOmpl {
 public:
  QuietOmpl() : before_(ompl::msg::getOutputHandler()) { ompl::msg::noOutputHandler(); }
  ~QuietOmpl() { ompl::msg::useOutputHandler(before_); }
  QuietOmpl(const QuietOmpl&) = delete;
  QuietOmpl& operator=(const QuietOmpl&) = delete;

 private:
  ompl::msg::OutputHandler* before_;
};

/// In cells.
Eigen::Vector3d pointOf(const ob::State* state) {
  const double* x = state->as<State>()->values;
  return {x[0], x[1], x[2]};
}

/// Straight lines through allowed cells.
class SightValidator : public ob::MotionValidator {
 public:
  SightValidator(const ob::SpaceInformationPtr& si, const GridShape& shape,
                 const std::vector<std::uint8_t>& allowed)
      : ob::MotionValidator(si), shape_(shape) {
    blocked_.reserve(allowed.size());
    for (const std::uint8_t a : allowed) blocked_.push_back(a == 0 ? 1 : 0);
  }
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return lineOfSight(shape_, blocked_, pointOf(a), pointOf(b));
  }
  bool checkMotion(const ob::State* a, const ob::State* b,
                   std::pair<ob::State*, double>& last_valid) const override {
    last_valid.second = 0.0;  // a line is taken whole or not at all
    return checkMotion(a, b);
  }

 private:
  GridShape shape_;
  std::vector<std::uint8_t> blocked_;
};

/// Centres of cells: the wanted ones, then the others in random order. OMPL's own generators are
/// all seeded from one place that anyone may have drawn from before, so they are not used.
class CentreSampler : public ob::ValidStateSampler {
 public:
  CentreSampler(const ob::SpaceInformation* si, const GridShape& shape,
                std::vector<CellIndex> cells, std::size_t wanted, std::uint64_t seed)
      : ob::ValidStateSampler(si),
        shape_(shape),
        cells_(std::move(cells)),
        wanted_(wanted),
        random_(seed) {}

  bool sample(ob::State* state) override {
    if (next_ == cells_.size()) return false;
    if (next_ >= wanted_) {  // one step of the Fisher-Yates shuffle
      const auto left = static_cast<std::uint64_t>(cells_.size() - next_);
      std::swap(cells_[next_], cells_[next_ + static_cast<std::size_t>(random_() % left)]);
    }
    const Eigen::Vector3i cell = shape_.cell(cells_[next_++]);
    for (int axis = 0; axis < 3; ++axis) {
      state->as<State>()->values[axis] = cell[axis] + 0.5;
    }
    return true;
  }
  bool sampleNear(ob::State* /*state*/, const ob::State* /*near*/, double /*distance*/) override {
    return false;  // only expansion asks for it
  }

 private:
  GridShape shape_;
  std::vector<CellIndex> cells_;
  std::size_t wanted_;
  std::size_t next_{0};
  std::mt19937_64 random_;
};

/// Nearest neighbours by looking at all: of equally near ones OMPL's trees would pick at random.
class OrderedPrm : public ompl::geometric::PRM {
 public:
  explicit OrderedPrm(const ob::SpaceInformationPtr& si) : ompl::geometric::PRM(si) {
    setNearestNeighbors<ompl::NearestNeighborsLinear>();
    nn_->setDistanceFunction([this](Vertex a, Vertex b) { return distanceFunction(a, b); });
  }
};

/// Wanted cells first.
std::vector<CellIndex> cellsToSample(const std::vector<std::uint8_t>& allowed,
                                     const std::vector<CellIndex>& wanted) {
  std::vector<CellIndex> cells = wanted;
  std::vector<std::uint8_t> rest = allowed;
  for (const CellIndex cell : wanted) rest[static_cast<std::size_t>(cell)] = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i] != 0) cells.push_back(static_cast<CellIndex>(i));
  }
  return cells;
}

ob::SpaceInformationPtr spaceOf(const GridShape& shape, const std::vector<std::uint8_t>& allowed) {
  auto space = std::make_shared<ob::RealVectorStateSpace>(3);
  ob::RealVectorBounds bounds(3);
  bounds.low = {0.0, 0.0, 0.0};
  bounds.high = {static_cast<double>(shape.nx), static_cast<double>(shape.ny),
                 static_cast<double>(shape.nz)};
  space->setBounds(bounds);
  auto si = std::make_shared<ob::SpaceInformation>(space);
  si->setStateValidityChecker([shape, &allowed](const ob::State* state) {
    const Eigen::Vector3i cell = pointOf(state).array().floor().cast<int>();
    return shape.contains(cell) && allowed[static_cast<std::size_t>(shape.index(cell))] != 0;
  });
  si->setMotionValidator(std::make_shared<SightValidator>(si, shape, allowed));
  si->setup();
  return si;
}

/// OMPL's graph by cells; the order in which OMPL lists it does not matter.
Roadmap roadmapOf(const ompl::geometric::PRM& prm, const ob::SpaceInformationPtr& si,
                  const GridShape& shape) {
  ob::PlannerData data(si);
  prm.getPlannerData(data);
  std::vector<CellIndex> cell_of(data.numVertices());
  for (unsigned int i = 0; i < data.numVertices(); ++i) {
    const Eigen::Vector3d p = pointOf(data.getVertex(i).getState());
    cell_of[i] = shape.index(p.array().floor().cast<int>());
  }
  Roadmap roadmap;
  roadmap.milestones = cell_of;
  std::sort(roadmap.milestones.begin(), roadmap.milestones.end());
  roadmap.edges.resize(cell_of.size());
  std::vector<unsigned int> to;
  for (unsigned int i = 0; i < data.numVertices(); ++i) {
    data.getEdges(i, to);
    auto& edges = roadmap.edges[roadmap.indexOf(cell_of[i])];
    for (const unsigned int j : to) {
      const Eigen::Vector3i step = shape.cell(cell_of[j]) - shape.cell(cell_of[i]);
      edges.push_back({roadmap.indexOf(cell_of[j]), step.cast<double>().norm()});
    }
    std::sort(edges.begin(), edges.end(),
              [](const Roadmap::Edge& a, const Roadmap::Edge& b) { return a.to < b.to; });
  }
  return roadmap;
}

bool connects(const Roadmap& roadmap, const std::vector<CellIndex>& wanted, std::size_t count) {
  if (count < 2) return true;
  const std::size_t root = roadmap.indexOf(wanted.front());
  if (root == roadmap.milestones.size()) return false;
  const Roadmap::Tree tree = roadmap.shortestFrom(root);
  return std::all_of(wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(count),
                     [&](CellIndex cell) {
                       const std::size_t i = roadmap.indexOf(cell);
                       return i < tree.length.size() && std::isfinite(tree.length[i]);
                     });
}

}  // namespace

std::size_t Roadmap::indexOf(CellIndex cell) const {
  const auto at = std::lower_bound(milestones.begin(), milestones.end(), cell);
  if (at == milestones.end() || *at != cell) return milestones.size();
  return static_cast<std::size_t>(at - milestones.begin());
}

Roadmap::Tree Roadmap::shortestFrom(std::size_t root) const {
  Tree tree;
  tree.length.assign(milestones.size(), std::numeric_limits<double>::infinity());
  tree.from.assign(milestones.size(), root);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  tree.length[root] = 0.0;
  queue.emplace(0.0, root);
  while (!queue.empty()) {
    const auto [length, i] = queue.top();
    queue.pop();
    if (length > tree.length[i]) continue;
    for (const Edge& edge : edges[i]) {
      const double there = length + edge.length;
      if (there >= tree.length[edge.to]) continue;
      tree.length[edge.to] = there;
      tree.from[edge.to] = i;
      queue.emplace(there, edge.to);
    }
  }
  return tree;
}

Roadmap growRoadmap(const GridShape& shape, const std::vector<std::uint8_t>& allowed,
                    const std::vector<CellIndex>& wanted, const RoadmapSettings& settings,
                    const Progress& progress) {
  const QuietOmpl quiet;
  const ob::SpaceInformationPtr si = spaceOf(shape, allowed);
  const std::vector<CellIndex> cells = cellsToSample(allowed, wanted);
  si->setValidStateSamplerAllocator([&](const ob::SpaceInformation* space) {
    return std::make_shared<CentreSampler>(space, shape, cells, wanted.size(), settings.seed);
  });
  auto problem = std::make_shared<ob::ProblemDefinition>(si);
  problem->setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(si));
  OrderedPrm prm(si);
  prm.setProblemDefinition(problem);
  prm.setup();
  const std::size_t least = std::min(std::max(settings.milestones, wanted.size()), cells.size());
  const std::size_t most = std::min(std::max(settings.milestones_max, least), cells.size());
  Roadmap roadmap;
  for (std::size_t goal = std::min(kBatch, least);; goal = std::min(goal + kBatch, most)) {
    progress.report("roadmap", static_cast<double>(goal) / static_cast<double>(most));
    prm.growRoadmap(ob::PlannerTerminationCondition(
        [&] { return prm.milestoneCount() >= goal || progress.cancelled(); }));
    if (goal < least && !progress.cancelled()) continue;
    roadmap = roadmapOf(prm, si, shape);
    if (goal >= most || progress.cancelled()) break;
    if (connects(roadmap, wanted, settings.connected)) break;
  }
  return roadmap;
}

}  // namespace tautline::planning
