/// @file
/// Rate mode does not depend on the resolution.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/mission/scene.h"
#include "planning_offline/risk/risk_model.h"
#include "planning_offline/risk/test/test_world.h"

namespace tautline::planning {
namespace {

// -------------------------------------------------

/// A room of 6.4 × 2.4 × 6.4 m with two boxes, at any cell size that divides 0.4 m; fields by
/// formula.
RiskModel roomModel(double resolution, const RiskParams& params) {
  const auto cells = [resolution](double length) {
    return static_cast<int>(std::lround(length / resolution));
  };
  VoxelMap map = emptyMap({cells(6.4), cells(2.4), cells(6.4)}, resolution);
  map.reel = Eigen::Vector3d(0.2, 0.2, 0.2);
  const std::vector<Box> boxes{{"a", {2.0, 0.0, 0.0}, {2.8, 2.4, 2.4}},
                               {"b", {3.6, 0.0, 3.2}, {4.4, 1.6, 6.4}}};
  const auto cleared = [&boxes](const Eigen::Vector3d& p) {
    const double walls = std::min(p.minCoeff(), (Eigen::Vector3d(6.4, 2.4, 6.4) - p).minCoeff());
    return std::min({walls, signedDistance(p, boxes[0]), signedDistance(p, boxes[1])});
  };
  MapFields fields = evenFields(map, 0.0F, 0.0F, 0.0F);
  const char* layers[] = {"terrain_stability", "slippage"};
  for (const char* name : layers)
    map.layers.push_back({name, std::vector<double>(map.cells.size())});
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const Eigen::Vector3d p = map.centre(static_cast<CellIndex>(i));
    const double distance = cleared(p);
    if (distance < 0.0) {
      map.cells[i] = CellState::kOccupied;
      continue;
    }
    fields.distance[i] = static_cast<float>(distance);
    fields.width[i] = static_cast<float>(0.4 + 2.0 * distance);
    fields.visibility[i] = static_cast<float>(2.0 + std::sin(p.x()) + std::cos(p.z()));
    map.layers[0].values[i] = 0.5 + 0.5 * std::sin(p.x() + 2.0 * p.z());
    map.layers[1].values[i] = 0.5 + 0.5 * std::cos(2.0 * p.x());
  }
  const auto string = std::make_shared<PolesString>(
      *map.reel, std::vector<Eigen::Vector3d>{{2.4, 1.0, 2.4}, {4.0, 1.6, 3.2}});
  return modelOf(std::move(map), std::move(fields), params, string);
}

/// Corners of a way past both boxes; centres of 0.4 m cells.
const std::vector<Eigen::Vector3d> kWay{{0.6, 0.6, 0.6}, {1.4, 1.0, 1.4}, {1.4, 1.4, 2.6},
                                        {3.0, 1.4, 2.6}, {3.4, 1.8, 3.0}, {5.0, 1.8, 4.6},
                                        {5.0, 1.8, 5.8}};

/// Risk of the way at cells of 0.4, 0.2 and 0.1 m.
std::array<double, 3> risksOfHalvings(const RiskParams& params,
                                      std::span<const Eigen::Vector3d> way) {
  return {roomModel(0.4, params).evaluate(way).risk, roomModel(0.2, params).evaluate(way).risk,
          roomModel(0.1, params).evaluate(way).risk};
}

/// The larger change of the two, relative.
double largestChange(const std::array<double, 3>& risks) {
  return std::max(std::abs(risks[1] / risks[0] - 1.0), std::abs(risks[2] / risks[1] - 1.0));
}

RiskParams allOnInRateMode() {
  RiskParams params;
  params.mode = RiskMode::kRate;
  params.scale = {{0.01, 1.0, 8.0}, 0.3, true};
  params.singularity.member = {0.03, 90.0, 5.0};
  params.terrain_stability.scale = 0.01;
  params.access.per_unit = 0.02;
  params.slippage.per_mud = 0.002;
  params.battery = {{0.05, 1.0, 0.0}, 20.0, 1.0};
  return params;
}

TEST(RateMode, HalvingTheVoxelChangesTheRiskOfAPathByLessThanTwoPercent) {
  RiskParams defaults;
  defaults.mode = RiskMode::kRate;
  struct Case {
    const char* name;
    RiskParams params;
  };
  for (const Case& c :
       {Case{"default elements", defaults}, Case{"12 elements", allOnInRateMode()}}) {
    double largest = 0.0;
    for (std::size_t points = 2; points <= kWay.size(); ++points) {
      const auto risks = risksOfHalvings(c.params, std::span(kWay).first(points));
      ASSERT_GT(risks[0], 0.1);
      EXPECT_LT(largestChange(risks), 0.02) << c.name << ", " << points << " points";
      largest = std::max(largest, largestChange(risks));
    }
    RecordProperty(c.name, std::to_string(largest));
  }
}

TEST(RateMode, HalvingTheVoxelChangesEachElementLittle) {
  struct Case {
    RiskElement element;
    double tolerance;
    std::function<void(RiskParams&)> turn_on;
  };
  // A field's samples miss where its membership bends; a contact forms somewhere within a step.
  const std::vector<Case> cases{
      {RiskElement::kDistance, 0.03,
       [](RiskParams& p) {
         p.distance.member = {0.02, 0.2, 1.0};
       }},
      {RiskElement::kScale, 0.01,
       [](RiskParams& p) {
         p.scale = {{0.02, 1.0, 8.0}, 0.3, false};
       }},
      {RiskElement::kVisibility, 0.01,
       [](RiskParams& p) {
         p.visibility.member = {0.02, 0.5, 4.0};
       }},
      {RiskElement::kSingularity, 0.01,
       [](RiskParams& p) {
         p.singularity.member = {0.03, 90.0, 5.0};
       }},
      {RiskElement::kTerrain, 0.01, [](RiskParams& p) { p.terrain_stability.scale = 0.02; }},
      {RiskElement::kActionLength, 1e-12, [](RiskParams& p) { p.action_length.per_metre = 0.02; }},
      {RiskElement::kTurn, 1e-12, [](RiskParams& p) { p.turn.risk = 0.02; }},
      {RiskElement::kAccess, 0.01,
       [](RiskParams& p) {
         p.access = {AccessCharacter::kVisibility, 0.05};
       }},
      {RiskElement::kTetherLength, 0.01, [](RiskParams& p) { p.tether_length.per_metre = 0.003; }},
      {RiskElement::kContacts, 0.04, [](RiskParams& p) { p.contacts.each = 0.01; }},
      {RiskElement::kSlippage, 0.02, [](RiskParams& p) { p.slippage.per_mud = 0.003; }},
      {RiskElement::kBattery, 0.01, [](RiskParams& p) {
         p.battery = {{0.05, 1.0, 0.0}, 20.0, 1.0};
       }}};
  for (const Case& c : cases) {
    RiskParams params = nothingOn();
    params.mode = RiskMode::kRate;
    c.turn_on(params);
    const auto risks = risksOfHalvings(params, kWay);
    const char* name = nameOf(c.element, kRiskElementNames);
    ASSERT_GT(risks[0], 0.05) << name;
    EXPECT_LT(largestChange(risks), c.tolerance) << name;
    RecordProperty(name, std::to_string(largestChange(risks)));
  }
}

TEST(RateMode, InterpolatesBetweenCellsOfTheSameKind) {
  RiskParams params = nothingOn();
  params.mode = RiskMode::kRate;
  params.reference_step = 1.0;
  params.terrain_stability.scale = 1.0;
  VoxelMap map = emptyMap({2, 1, 1}, 1.0);
  map.layers.push_back({"terrain_stability", {0.1, 0.6}});
  const std::vector<Eigen::Vector3d> way{{0.5, 0.5, 0.5}, {0.9, 0.5, 0.5}};
  const double here = -std::log(0.9);
  const double there = -std::log(0.4);
  EXPECT_NEAR(modelOf(map, {}, params).evaluate(way).cost, 0.4 * (here + 0.2 * (there - here)),
              1e-15);
  map.cells[1] = CellState::kOccupied;
  EXPECT_NEAR(modelOf(map, {}, params).evaluate(way).cost, 0.4 * here, 1e-15);
}

TEST(RateMode, LongStepsAreTheirOwnSubdivision) {
  RiskParams params;
  params.mode = RiskMode::kRate;
  const RiskModel model = roomModel(0.2, params);
  const std::vector<Eigen::Vector3d> coarse{{0.7, 0.7, 0.7}, {0.7, 0.7, 1.9}};
  std::vector<Eigen::Vector3d> fine;
  for (int i = 0; i <= 6; ++i) fine.emplace_back(0.7, 0.7, 0.7 + 0.2 * i);
  EXPECT_NEAR(model.evaluate(coarse).cost, model.evaluate(fine).cost, 1e-12);
}

TEST(RateMode, PerStateDoesDependOnIt) {
  // The contrast that rate mode is for: twice the states, nearly twice the cost.
  RiskParams params = nothingOn();
  params.terrain_stability.scale = 0.1;
  std::vector<Eigen::Vector3d> coarse;
  std::vector<Eigen::Vector3d> fine;
  for (int i = 0; i <= 10; ++i) coarse.emplace_back(0.6, 0.6, 0.6 + 0.4 * i);
  for (int i = 0; i <= 20; ++i) fine.emplace_back(0.6, 0.6, 0.6 + 0.2 * i);
  const RiskModel model = roomModel(0.1, params);
  EXPECT_GT(model.evaluate(fine).cost, 1.7 * model.evaluate(coarse).cost);
}

}  // namespace
}  // namespace tautline::planning
