#pragma once

/// @file
/// What the tests of the least-risk planners share.

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "planning_offline/planner/makers.h"
#include "planning_offline/search/test/small_world.h"

namespace tautline::planning::testing {

inline PlanProblem problemOf(const SmallWorld& world, std::vector<double> reward = {}) {
  return {.lattice = world.lattice.get(),
          .risk = world.risk.get(),
          .reward = std::move(reward),
          .start = world.start};
}

inline PlanResult planTo(const Planner& planner, const SmallWorld& world, CellIndex goal,
                         PlanOptions options = {}) {
  options.goal = goal;
  return planner.plan(problemOf(world), options, Progress());
}

/// Each connectivity, turn law and mode; `index` numbers them all.
inline WorldKind kindNumber(int index) {
  constexpr std::array kConnectivity{Connectivity::kFaces, Connectivity::kEdges,
                                     Connectivity::kVertices};
  constexpr std::array kLaw{TurnLaw::kConstant, TurnLaw::kLinear, TurnLaw::kQuadratic,
                            TurnLaw::kThreshold};
  const auto i = static_cast<std::size_t>(index);
  return {.connectivity = kConnectivity[i % 3],
          .planar = i / 3 % 2 == 0,
          .law = kLaw[i / 6 % 4],
          .mode = i / 24 % 2 == 0 ? RiskMode::kPerState : RiskMode::kRate};
}
inline constexpr int kKinds = 48;

/// Least costs by trying everything.
struct Truth {
  bool known{false};           ///< The map was small enough.
  std::vector<double> simple;  ///< Of simple paths.
  std::vector<double> walk;    ///< Of walks of at most `steps` steps.
  int steps{0};
};
inline Truth truthOf(const SmallWorld& world) {
  Truth truth;
  Oracle oracle(world);
  truth.known = oracle.simpleOptima(30'000, truth.simple);
  truth.steps = 9;
  if (truth.known) truth.walk = oracle.walkOptima(truth.steps, truth.simple);
  return truth;
}

}  // namespace tautline::planning::testing
