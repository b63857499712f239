// Against OMPL for pure clearance cost (docs/utility.md, "prm"): cost over time of RRT* and PRM*,
// and what the lattice with straight lines takes and finds, on the same map in the same run.
//
//   planning_prm_benchmark                    10 s of CPU time for each OMPL planner
//   TAUTLINE_OMPL_SECONDS=60 planning_prm_benchmark

#include <ompl/base/MotionValidator.h>
#include <ompl/base/OptimizationObjective.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ScopedState.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/prm/PRMstar.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "planning_offline/field/reference/synthetic_map.h"
#include "planning_offline/map/load_map.h"
#include "planning_offline/planner/prm/benchmark/clearance_problem.h"

namespace tautline::planning {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using State = ob::RealVectorStateSpace::StateType;

/// Of the whole process, so that what else the machine does takes nothing away from either side.
double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double omplSeconds() {
  const char* text = std::getenv("TAUTLINE_OMPL_SECONDS");
  return text == nullptr ? 10.0 : std::atof(text);
}

Eigen::Vector3d pointOf(const ob::State* state) {
  const double* x = state->as<State>()->values;
  return {x[0], x[1], x[2]};
}

class ClearanceObjective : public ob::OptimizationObjective {
 public:
  ClearanceObjective(const ob::SpaceInformationPtr& si, const ClearanceProblem& problem)
      : ob::OptimizationObjective(si), problem_(problem) {}
  ob::Cost stateCost(const ob::State* /*state*/) const override { return ob::Cost(0.0); }
  ob::Cost motionCost(const ob::State* a, const ob::State* b) const override {
    return ob::Cost(problem_.cost(pointOf(a), pointOf(b)));
  }

 private:
  const ClearanceProblem& problem_;
};

class SightValidator : public ob::MotionValidator {
 public:
  SightValidator(const ob::SpaceInformationPtr& si, const ClearanceProblem& problem)
      : ob::MotionValidator(si), problem_(problem) {}
  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    return problem_.sees(pointOf(a), pointOf(b));
  }
  bool checkMotion(const ob::State* a, const ob::State* b,
                   std::pair<ob::State*, double>& last_valid) const override {
    last_valid.second = 0.0;
    return checkMotion(a, b);
  }

 private:
  const ClearanceProblem& problem_;
};

/// Best cost by the time it was found [s].
using Course = std::vector<std::pair<double, double>>;

double bestOf(const Course& course) {
  return course.empty() ? std::numeric_limits<double>::infinity() : course.back().second;
}

/// First time that the cost was within `factor` of `cost`; infinite if it never was.
double timeWithin(const Course& course, double cost, double factor) {
  for (const auto& [time, c] : course) {
    if (c <= factor * cost) return time;
  }
  return std::numeric_limits<double>::infinity();
}

/// OMPL on the problem, in slices, so that other work can be timed between them.
class OmplRun {
 public:
  template <class Planner>
  static OmplRun of(const ClearanceProblem& problem) {
    OmplRun run(problem);
    run.planner_ = std::make_shared<Planner>(run.si_);
    run.planner_->setProblemDefinition(run.definition_);
    run.planner_->setup();
    return run;
  }

  void runFor(double seconds) {
    const double begin = cpuSeconds();
    // A planner that tells of better paths is asked while it runs, any other after the slice.
    const double before = used_;
    definition_->setIntermediateSolutionCallback(
        [&](const ob::Planner*, const std::vector<const ob::State*>&, const ob::Cost cost) {
          note(before + cpuSeconds() - begin, cost.value());
        });
    planner_->solve(
        ob::PlannerTerminationCondition([&] { return cpuSeconds() - begin >= seconds; }));
    used_ += cpuSeconds() - begin;
    if (!definition_->hasExactSolution()) return;
    CellPoints points;
    const auto path = std::static_pointer_cast<og::PathGeometric>(definition_->getSolutionPath());
    for (const ob::State* state : path->getStates()) points.push_back(pointOf(state));
    note(used_, problem_->cost(points));
  }

  [[nodiscard]] const Course& course() const noexcept { return course_; }

 private:
  explicit OmplRun(const ClearanceProblem& problem) : problem_(&problem) {
    const GridShape& shape = problem.lattice().shape();
    auto space = std::make_shared<ob::RealVectorStateSpace>(3);
    ob::RealVectorBounds bounds(3);
    bounds.low = {0.0, 0.0, 0.0};
    bounds.high = {static_cast<double>(shape.nx), static_cast<double>(shape.ny),
                   static_cast<double>(shape.nz)};
    space->setBounds(bounds);
    si_ = std::make_shared<ob::SpaceInformation>(space);
    si_->setStateValidityChecker(
        [&problem](const ob::State* state) { return problem.free(pointOf(state)); });
    si_->setMotionValidator(std::make_shared<SightValidator>(si_, problem));
    si_->setup();
    definition_ = std::make_shared<ob::ProblemDefinition>(si_);
    ob::ScopedState<ob::RealVectorStateSpace> start(space);
    ob::ScopedState<ob::RealVectorStateSpace> goal(space);
    for (unsigned axis = 0; axis < 3; ++axis) {
      start->values[axis] = problem.start()[axis];
      goal->values[axis] = problem.goal()[axis];
    }
    definition_->setStartAndGoalStates(start, goal, 0.5);
    definition_->setOptimizationObjective(std::make_shared<ClearanceObjective>(si_, problem));
  }

  void note(double time, double cost) {
    if (cost < bestOf(course_)) course_.emplace_back(time, cost);
  }

  const ClearanceProblem* problem_;
  ob::SpaceInformationPtr si_;
  ob::ProblemDefinitionPtr definition_;
  ob::PlannerPtr planner_;
  double used_{0.0};
  Course course_;
};

void report(const char* name, const Course& course) {
  std::printf("%s, cost after seconds:", name);
  for (const auto& [time, cost] : course) std::printf(" %.2f:%.4f", time, cost);
  std::printf("\n");
}

void compare(benchmark::State& state, const ClearanceProblem& problem) {
  ompl::msg::noOutputHandler();
  ompl::RNG::setSeed(1);
  const double seconds = omplSeconds();
  constexpr int kSlices = 5;
  for (auto _ : state) {
    OmplRun rrt = OmplRun::of<og::RRTstar>(problem);
    OmplRun prm = OmplRun::of<og::PRMstar>(problem);
    double ours = std::numeric_limits<double>::infinity();
    double ours_cost = 0.0;
    for (int slice = 0; slice < kSlices; ++slice) {
      rrt.runFor(seconds / kSlices);
      prm.runFor(seconds / kSlices);
      const double begin = cpuSeconds();
      ours_cost = problem.cost(problem.solve());
      ours = std::min(ours, cpuSeconds() - begin);
    }
    report("RRT*", rrt.course());
    report("PRM*", prm.course());
    const double rrt_best = bestOf(rrt.course());
    const double rrt_time = timeWithin(rrt.course(), rrt_best, 1.05);
    state.counters["ours_s"] = ours;
    state.counters["ours_cost"] = ours_cost;
    state.counters["rrt_cost"] = rrt_best;
    state.counters["prm_cost"] = bestOf(prm.course());
    state.counters["rrt_within_5pc_s"] = rrt_time;
    const double rrt_like_ours = timeWithin(rrt.course(), ours_cost, 1.02);
    state.counters["rrt_within_2pc_of_ours_s"] = rrt_like_ours;
    state.counters["prm_within_5pc_s"] = timeWithin(prm.course(), rrt_best, 1.05);
    state.counters["ratio_5pc"] = rrt_time / ours;
    state.counters["ratio_2pc_of_ours"] = rrt_like_ours / ours;
    state.counters["cost_ratio"] = ours_cost / rrt_best;
    state.SetIterationTime(ours);
  }
}

void rooms(benchmark::State& state) {
  compare(state, ClearanceProblem(roomsMap({100, 100, 100}, 1)));
}
BENCHMARK(rooms)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);

void geb079(benchmark::State& state) {
  const char* data = std::getenv("TAUTLINE_DATA");
  const std::filesystem::path folder =
      data == nullptr ? std::filesystem::path(TAUTLINE_SOURCE_DIR) / "../shared/data" : data;
  const std::filesystem::path file = folder / "octomap/geb079.bt";
  if (!std::filesystem::exists(file)) {
    state.SkipWithError("no octomap/geb079.bt under TAUTLINE_DATA");
    return;
  }
  compare(state, ClearanceProblem(loadMap(file, {})));
}
BENCHMARK(geb079)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tautline::planning
