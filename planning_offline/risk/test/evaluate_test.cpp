#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "planning_offline/risk/risk_model.h"
#include "planning_offline/risk/test/test_world.h"

namespace tautline::planning {
namespace {

double of(const PerElement& values, RiskElement e) { return values[static_cast<std::size_t>(e)]; }

/// The definition: 1 − Π_i Π_k (1 − r_k), multiplied out.
double riskOfStates(const std::vector<StateRisk>& states) {
  double success = 1.0;
  for (const StateRisk& state : states) {
    for (const double r : state.elements) success *= 1.0 - r;
  }
  return 1.0 - success;
}

TEST(Evaluate, TableOfAShortPathByHand) {
  // Five cells in a row; the vehicle goes 0 → 1 → 2 → 1, with a contact beyond x = 2.
  VoxelMap map = emptyMap({5, 1, 2}, 1.0);
  map.layers.push_back({"terrain_stability", {.1, .2, .3, 0, 0, 0, 0, 0, 0, 0}});
  map.layers.push_back({"slippage", {1, .5, 0, 0, 0, 0, 0, 0, 0, 0}});
  RiskParams params = nothingOn();
  params.terrain_stability.scale = 0.5;
  params.action_length.per_metre = 0.06;
  params.turn = {TurnLaw::kConstant, 0.07, 0.7, 12.0};
  params.access.per_unit = 0.04;
  params.tether_length.per_metre = 0.01;
  params.contacts.each = 0.03;
  params.slippage.per_mud = 0.2;
  params.battery = {{0.5, 1.0, 0.0}, 20.0, 1.0};
  MapFields fields = evenFields(map, 9.0F, 2.0F, 9.0F);
  fields.width[1] = 1.5F;
  const Eigen::Vector3d reel(0.5, 0.5, 0.5);
  const auto string =
      std::make_shared<PolesString>(reel, std::vector<Eigen::Vector3d>{{2.0, 0.5, 1.5}});
  const RiskModel model = modelOf(map, fields, params, string);
  const RiskReport report = model.evaluate(std::vector<CellIndex>{0, 1, 2, 1});

  ASSERT_EQ(report.states.size(), 4U);
  // Columns: terrain, action length, turn, access, tether length, contacts, slippage, battery.
  const double bent = std::sqrt(1.5 * 1.5 + 1.0) + std::sqrt(0.5 * 0.5 + 1.0);
  const double expected[4][8] = {{0.05, 0, 0, 0, 0, 0, 0, 0},
                                 {0.1, 0.06, 0, 0.02, 0.01, 0, 0.2 * 1.0 * 0.5, 0.025},
                                 {0.15, 0.06, 0, 0, 0.01 * bent, 0.03, 0, 0.05},
                                 {0.1, 0.06, 0.07, 0.02, 0.01, 0, 0.2 * 1.5 * 0.5, 0.075}};
  constexpr RiskElement kColumns[8] = {RiskElement::kTerrain,      RiskElement::kActionLength,
                                       RiskElement::kTurn,         RiskElement::kAccess,
                                       RiskElement::kTetherLength, RiskElement::kContacts,
                                       RiskElement::kSlippage,     RiskElement::kBattery};
  double success = 1.0;
  for (std::size_t i = 0; i < 4; ++i) {
    double finish = 1.0;
    for (std::size_t k = 0; k < 8; ++k) {
      EXPECT_NEAR(of(report.states[i].elements, kColumns[k]), expected[i][k], 1e-15)
          << "state " << i << ' ' << nameOf(kColumns[k], kRiskElementNames);
      finish *= 1.0 - expected[i][k];
    }
    EXPECT_NEAR(report.states[i].risk, 1.0 - finish, 1e-15);
    EXPECT_EQ(report.states[i].position, map.centre(i == 2 ? 2 : i == 0 ? 0 : 1));
    success *= finish;
  }
  EXPECT_NEAR(report.risk, 1.0 - success, 1e-15);
  EXPECT_NEAR(report.states[2].tether_length, bent, 1e-15);
  ASSERT_EQ(report.states[2].contacts.size(), 1U);
  EXPECT_EQ(report.states[2].contacts[0], Eigen::Vector3d(2.0, 0.5, 1.5));
  EXPECT_TRUE(report.states[3].contacts.empty());
}

TEST(Evaluate, OfNothingAndOfStaying) {
  RiskParams params = nothingOn();
  params.distance.member = {0.04, 0.2, 1.2};
  const VoxelMap map = emptyMap({3, 3, 3}, 0.4);
  const MapFields fields = evenFields(map, 0.0F, 1.0F, 1.0F);
  const RiskModel per_state = modelOf(map, fields, params);
  EXPECT_EQ(per_state.evaluate(std::vector<CellIndex>{}).risk, 0.0);
  EXPECT_NEAR(per_state.evaluate(std::vector<CellIndex>{4}).risk, 0.04, 1e-15);  // s_0 counts
  params.mode = RiskMode::kRate;
  EXPECT_EQ(modelOf(map, fields, params).evaluate(std::vector<CellIndex>{4}).risk, 0.0);
}

TEST(Evaluate, StandingStillIsNoTurnAndHidesNone) {
  RiskParams params = nothingOn();
  params.turn.risk = 0.05;
  const RiskModel model = modelOf(emptyMap({3, 1, 3}, 1.0), {}, params);
  const GridShape& shape = model.map().shape;
  const auto turnsOf = [&](const Eigen::Vector3i& last) {
    std::vector<CellIndex> path{shape.index({0, 0, 0}), shape.index({1, 0, 0})};
    path.push_back(path.back());
    path.push_back(shape.index(last));
    std::vector<double> turns;
    for (const StateRisk& state : model.evaluate(path).states)
      turns.push_back(std::round(of(state.elements, RiskElement::kTurn) * 1e12) / 1e12);
    return turns;
  };
  EXPECT_EQ(turnsOf({1, 0, 1}), (std::vector<double>{0, 0, 0, 0.05}));
  EXPECT_EQ(turnsOf({2, 0, 0}), (std::vector<double>{0, 0, 0, 0}));
}

TEST(Evaluate, ForbiddenStatesAreCertainFailureInBothModes) {
  for (const RiskMode mode : {RiskMode::kPerState, RiskMode::kRate}) {
    RiskParams params = nothingOn();
    params.mode = mode;
    params.surface.scale = 1.0;
    VoxelMap map = emptyMap({4, 1, 1}, 0.4);
    map.layers.push_back({"surface", {0.0, 0.0, 1.0, 0.0}});
    const RiskModel model = modelOf(map, {}, params);
    EXPECT_EQ(model.evaluate(std::vector<CellIndex>{0, 1}).risk, 0.0);
    const RiskReport through = model.evaluate(std::vector<CellIndex>{1, 2, 3});
    EXPECT_EQ(through.risk, 1.0);
    EXPECT_EQ(of(through.states[1].elements, RiskElement::kSurface), 1.0);
    EXPECT_EQ(model.evaluate(std::vector<CellIndex>{2}).risk, 1.0);
    EXPECT_TRUE(std::isinf(model.startCost(2)));
    EXPECT_TRUE(std::isinf(model.stepCost(1, kNoDirection, directionOf({1, 0, 0}), 2)));
    EXPECT_EQ(model.stepCost(0, kNoDirection, directionOf({1, 0, 0}), 1), 0.0);
    // Beside a forbidden cell, off the centre: that cell forbids only inside itself.
    const std::vector<Eigen::Vector3d> near{{0.2, 0.2, 0.2}, {0.79, 0.2, 0.2}};
    EXPECT_EQ(model.evaluate(near).risk, 0.0);
  }
}

TEST(Evaluate, BeyondALimitOfTheTetherIsCertainFailure) {
  const VoxelMap map = emptyMap({6, 4, 1}, 1.0);
  const auto string = std::make_shared<PolesString>(Eigen::Vector3d(0.5, 1.5, 0.5),
                                                    std::vector<Eigen::Vector3d>{{3.0, 1.5, 0.5}});
  const auto riskOf = [&](const TetherLimits& limits, std::vector<Eigen::Vector3d> points) {
    RiskParams params = nothingOn();
    params.tether_limits = limits;
    return modelOf(map, {}, params, string).evaluate(points);
  };
  const std::vector<Eigen::Vector3d> level{{0.5, 1.5, 0.5}, {2.5, 1.5, 0.5}, {4.5, 1.5, 0.5}};
  EXPECT_EQ(riskOf({4.0, -1, -90.0}, level).risk, 0.0);
  const RiskReport longer = riskOf({3.9, -1, -90.0}, level);
  EXPECT_EQ(longer.risk, 1.0);
  EXPECT_EQ(of(longer.states[1].elements, RiskElement::kTetherLength), 0.0);
  EXPECT_EQ(of(longer.states[2].elements, RiskElement::kTetherLength), 1.0);
  EXPECT_EQ(of(riskOf({0.0, 0, -90.0}, level).states[2].elements, RiskElement::kContacts), 1.0);
  EXPECT_EQ(riskOf({0.0, 1, 0.0}, level).risk, 0.0);
  const RiskReport low = riskOf({0.0, 1, 0.0}, {{0.5, 1.5, 0.5}, {2.5, 0.5, 0.5}});
  EXPECT_EQ(of(low.states[1].elements, RiskElement::kTetherLength), 1.0);
  EXPECT_EQ(riskOf({0.0, 1, -30.0}, {{0.5, 1.5, 0.5}, {2.5, 0.5, 0.5}}).risk, 0.0);
  string->forbidBeyond(0);
  const RiskReport touching = riskOf({}, level);
  EXPECT_EQ(touching.risk, 1.0);
  EXPECT_EQ(of(touching.states[1].elements, RiskElement::kContacts), 0.0);
  EXPECT_EQ(of(touching.states[2].elements, RiskElement::kContacts), 1.0);
}

/// A random world in which every element has something to say.
struct RandomWorld {
  VoxelMap map;
  MapFields fields;
  RiskParams params;
  std::shared_ptr<TautString> string;
  std::vector<std::uint8_t> free;
  Connectivity connectivity{Connectivity::kVertices};
};

RandomWorld randomWorld(std::mt19937& random, RiskMode mode) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto between = [&](double a, double b) { return a + (b - a) * unit(random); };
  const auto size = [&] { return std::uniform_int_distribution<int>(1, 5)(random); };
  RandomWorld w;
  w.map = emptyMap({size() + 1, size(), size()}, between(0.1, 0.9));
  w.map.origin = {between(-3, 3), between(-3, 3), between(-3, 3)};
  w.map.reel = w.map.centre(0) + Eigen::Vector3d(0.01, 0.02, 0.03);
  const std::size_t cells = w.map.shape.size();
  w.free.assign(cells, 1);
  for (std::size_t i = 0; i < cells; ++i) {
    if (unit(random) < 0.1) {
      w.map.cells[i] = CellState::kOccupied;
      w.free[i] = 0;
    }
  }
  // Both neighbours of the first face free: there is a step.
  w.map.cells[0] = w.map.cells[1] = CellState::kFree;
  w.free[0] = w.free[1] = 1;
  for (const char* name : {"dynamic_threat", "verticality", "lateral_inclination",
                           "terrain_stability", "surface", "slippage"}) {
    MapLayer layer{name, std::vector<double>(cells)};
    for (double& value : layer.values) value = between(0.0, 0.9);
    w.map.layers.push_back(layer);
  }
  w.fields = evenFields(w.map, 0.0F, 0.0F, 0.0F);
  for (auto* field : {&w.fields.distance, &w.fields.width, &w.fields.visibility}) {
    for (float& value : *field) value = static_cast<float>(between(0.2, 3.0));
  }
  RiskParams& p = w.params;
  p.mode = mode;
  p.reference_step = between(0.1, 1.0);
  if (mode == RiskMode::kPerState && unit(random) < 0.5) p.quantum = 0.01;
  p.cap = between(0.2, 1.0);
  p.distance.member = {between(0, 0.3), 0.2, 1.5};
  p.distance.tolerance = between(0, 0.3);
  p.scale = {{between(0, 0.3), 1.0, 4.0}, between(0.1, 0.5), true};  // some cells are granular
  p.visibility.member = {between(0, 0.3), 0.5, 4.0};
  p.dynamic_threat.dwell = between(0, 0.5);
  p.singularity.member = {between(0, 0.5), 90.0, 10.0};
  for (LayerParams* layer :
       {&p.verticality, &p.lateral_inclination, &p.terrain_stability, &p.surface})
    layer->scale = between(0, 0.3);
  p.action_length.per_metre = between(0, 0.2);
  p.turn = {kTurnLawNames[std::uniform_int_distribution<std::size_t>(0, 3)(random)].value,
            between(0, 0.2), between(-0.5, 0.9), 3.0};
  p.access = {unit(random) < 0.5 ? AccessCharacter::kWidth : AccessCharacter::kVisibility,
              between(0, 0.2)};
  p.tether_length.per_metre = between(0, 0.1);
  p.contacts.each = between(0, 0.1);
  p.slippage.per_mud = between(0, 0.1);
  p.battery = {{between(0, 0.5), 1.0, 0.1}, between(1, 10), between(0, 3)};
  if (unit(random) < 0.2) p.tether_limits = {between(1, 6), 1, between(-80, -20)};
  const double span = w.map.shape.nx * w.map.resolution;
  std::vector<Eigen::Vector3d> poles;
  for (const double part : {0.4, 0.8})
    poles.push_back(w.map.origin + Eigen::Vector3d(part * span, between(0, 1), between(0, 1)));
  const auto string = std::make_shared<PolesString>(*w.map.reel, poles);
  w.string = string;
  w.connectivity =
      kConnectivityNames[std::uniform_int_distribution<std::size_t>(0, 2)(random)].value;
  if (unit(random) < 0.1) string->forbidBeyond(1);
  return w;
}

/// What a search adds up along a walk, state by state.
std::vector<double> searchCosts(const RiskModel& model, const std::vector<CellIndex>& walk) {
  const VoxelMap& map = model.map();
  TautString& string = *model.string();
  const auto tether = [&](StackId stack, CellIndex cell) {
    const Eigen::Vector3d position = map.centre(cell);
    if (!model.elevationAllowed(string.anchor(stack), position)) return HUGE_VAL;
    if (string.touchesForbidden(stack)) return HUGE_VAL;
    return model.tetherCost(string.length(stack, position), string.contactCount(stack));
  };
  StackId stack = string.move(kStraight, string.reel(), map.centre(walk.front()));
  Accumulators sums;
  Direction incoming = kNoDirection;
  std::vector<double> costs{model.startCost(walk.front()) +
                            model.startShare(tether(stack, walk.front()))};
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const CellIndex u = walk[i - 1];
    const CellIndex v = walk[i];
    const Direction d = directionOf(map.shape.cell(v) - map.shape.cell(u));
    const double step = map.resolution * stepLength(d);
    const double before = tether(stack, u) + model.accumulatorCost(sums, u);
    stack = string.move(stack, map.centre(u), map.centre(v));
    sums = model.advance(sums, u, v, step);
    const double after = tether(stack, v) + model.accumulatorCost(sums, v);
    costs.push_back(model.stepCost(u, incoming, d, v) + model.overStep(before, after, step));
    incoming = d;
  }
  return costs;
}

class EvaluateEqualsStepCosts : public ::testing::TestWithParam<RiskMode> {};

TEST_P(EvaluateEqualsStepCosts, OnRandomWalksOfRandomLattices) {
  std::mt19937 random(20240317);
  int finite_walks = 0;
  int infinite_walks = 0;
  std::array<int, kRiskElements> seen{};
  for (int world = 0; world < 400; ++world) {
    const RandomWorld w = randomWorld(random, GetParam());
    const Lattice lattice(w.map.shape, w.connectivity, w.free);
    const RiskModel model = modelOf(w.map, w.fields, w.params, w.string);
    const std::vector<CellIndex> walk = randomWalk(lattice, 12, random);
    const std::vector<double> costs = searchCosts(model, walk);
    const RiskReport report = model.evaluate(walk);
    ASSERT_EQ(report.states.size(), costs.size());
    double sum = 0.0;
    for (std::size_t i = 0; i < costs.size(); ++i) {
      ASSERT_NEAR(report.states[i].risk, riskOfCost(costs[i]), 1e-12)
          << "world " << world << " state " << i;
      sum += costs[i];
    }
    if (std::isinf(sum)) {
      ASSERT_EQ(report.risk, 1.0) << world;
      ASSERT_TRUE(std::isinf(report.cost)) << world;
      ++infinite_walks;
    } else {
      ASSERT_NEAR(report.cost, sum, 1e-12 * (1.0 + sum)) << world;
      ASSERT_NEAR(report.risk, riskOfStates(report.states), 1e-12) << world;
      ++finite_walks;
    }
    for (std::size_t k = 0; k < kRiskElements; ++k) {
      if (report.element_cost[k] > 0.0) ++seen[k];
    }
  }
  EXPECT_GT(finite_walks, 200);
  EXPECT_GT(infinite_walks, 20);
  for (std::size_t k = 0; k < kRiskElements; ++k)
    EXPECT_GT(seen[k], 50) << kRiskElementNames[k].name;
}

INSTANTIATE_TEST_SUITE_P(BothModes, EvaluateEqualsStepCosts,
                         ::testing::Values(RiskMode::kPerState, RiskMode::kRate),
                         [](const auto& p) { return nameOf(p.param, kRiskModeNames); });

}  // namespace
}  // namespace tautline::planning
