#pragma once

/// @file
/// What the tests of the least-risk planners share.

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "planning_offline/planner/makers.h"
#include "planning_offline/search/test/small_world.h"

namespace tautline::planning::testing {

/// Rows of a planar map from its far side (large z) to its near one: '#' occupied, 'm' muddy,
/// 'd' dark (of high locale risk), 's' the start.
inline SmallWorld picture(const std::vector<std::string>& rows, Connectivity connectivity) {
  const GridShape shape{static_cast<int>(rows[0].size()), 1, static_cast<int>(rows.size())};
  SmallWorld world = emptyWorld(shape, connectivity);
  MapLayer mud{"slippage", std::vector<double>(shape.size(), 0.0)};
  MapLayer dark{"surface", std::vector<double>(shape.size(), 0.0)};
  for (int z = 0; z < shape.nz; ++z) {
    for (int x = 0; x < shape.nx; ++x) {
      const char c = rows[static_cast<std::size_t>(shape.nz - 1 - z)][static_cast<std::size_t>(x)];
      const CellIndex cell = shape.index({x, 0, z});
      const auto i = static_cast<std::size_t>(cell);
      if (c == '#') world.map->cells[i] = CellState::kOccupied;
      if (c == 'm') mud.values[i] = 1.0;
      if (c == 'd') dark.values[i] = 1.0;
      if (c == 's') world.start = cell;
    }
  }
  world.map->layers = {mud, dark};
  world.params.action_length.per_metre = 0.02;
  return world;
}

inline CellIndex cellAt(const SmallWorld& world, int x, int z) {
  return world.map->shape.index({x, 0, z});
}

inline std::vector<double> rewardsAt(const SmallWorld& world,
                                     const std::vector<std::pair<CellIndex, double>>& where) {
  std::vector<double> reward(world.map->shape.size(), 0.0);
  for (const auto& [cell, value] : where) reward[static_cast<std::size_t>(cell)] = value;
  return reward;
}

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

/// The same world, whose obstacles the tether may all touch.
inline SmallWorld withoutMarks(const SmallWorld& world) {
  SmallWorld blunt;
  blunt.map = std::make_shared<VoxelMap>(*world.map);
  blunt.map->no_contact.clear();
  blunt.fields = world.fields;
  blunt.params = world.params;
  blunt.tethered = world.tethered;
  blunt.connectivity = world.connectivity;
  blunt.start = world.start;
  blunt.build();
  return blunt;
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
