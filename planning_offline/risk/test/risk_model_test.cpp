#include "planning_offline/risk/risk_model.h"

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.h"
#include "planning_offline/risk/test/test_world.h"

namespace tautline::planning {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr GridShape kRow{3, 1, 1};

VoxelMap rowWithLayer(const std::string& name, std::vector<double> values) {
  VoxelMap map = emptyMap(kRow, 1.0);
  map.layers.push_back({name, std::move(values)});
  return map;
}

InputProblem problemOf(VoxelMap map) {
  try {
    (void)modelOf(std::move(map), {}, nothingOn());
  } catch (const InputError& e) {
    return e.problem();
  }
  ADD_FAILURE() << "no InputError";
  return {};
}

TEST(RiskModel, LocaleRisksComeFromTheirFields) {
  RiskParams params = nothingOn();
  params.distance.member = {0.1, 0.0, 1.0};
  params.scale = {{0.2, 1.0, 2.5}, 0.5, true};
  params.visibility.member = {0.4, 0.0, 4.0};
  MapFields fields;
  fields.distance = {0.0F, 0.25F, 2.0F};
  fields.width = {0.5F, 0.75F, 2.0F};
  fields.visibility = {0.0F, 1.0F, 4.0F};
  const RiskModel model = modelOf(emptyMap(kRow, 1.0), fields, params);
  EXPECT_DOUBLE_EQ(model.localeRisk(RiskElement::kDistance, 1), 0.075);
  EXPECT_DOUBLE_EQ(model.localeRisk(RiskElement::kScale, 1), 0.2 * 1.0 / 1.5);
  EXPECT_DOUBLE_EQ(model.localeRisk(RiskElement::kVisibility, 1), 0.3);
  EXPECT_EQ(model.localeRisk(RiskElement::kScale, 0), 1.0);
  EXPECT_EQ(model.localeRisk(RiskElement::kTerrain, 0), 0.0);
  EXPECT_THAT(model.enabled(),
              ElementsAre(RiskElement::kDistance, RiskElement::kScale, RiskElement::kVisibility));
  // The sum of costs, not the cost of a sum.
  EXPECT_DOUBLE_EQ(model.costs().locale[1], -std::log(0.925 * (1.0 - 0.2 / 1.5) * 0.7));
  EXPECT_EQ(model.costs().locale[0], kInfinity);
  EXPECT_EQ(model.costs().locale[2], 0.0);
}

TEST(RiskModel, LayersFeedTheirElements) {
  struct Case {
    RiskElement element;
    void (*turn_on)(RiskParams&);
    double expected;  // of a layer value of 0.5
  };
  for (const Case& c :
       {Case{RiskElement::kVerticality, [](RiskParams& p) { p.verticality.scale = 0.4; }, 0.2},
        Case{RiskElement::kInclination, [](RiskParams& p) { p.lateral_inclination.scale = 0.4; },
             0.2},
        Case{RiskElement::kTerrain, [](RiskParams& p) { p.terrain_stability.scale = 0.4; }, 0.2},
        Case{RiskElement::kSurface, [](RiskParams& p) { p.surface.scale = 0.4; }, 0.2},
        Case{RiskElement::kDynamicThreat, [](RiskParams& p) { p.dynamic_threat.dwell = 2.0; },
             0.75}}) {
    const std::string name = nameOf(c.element, kRiskElementNames);
    RiskParams params = nothingOn();
    c.turn_on(params);
    const RiskModel model = modelOf(rowWithLayer(name, {0.0, 0.5, 0.5}), {}, params);
    EXPECT_EQ(model.localeRisk(c.element, 0), 0.0) << name;
    EXPECT_DOUBLE_EQ(model.localeRisk(c.element, 1), c.expected) << name;
    EXPECT_DOUBLE_EQ(model.costs().locale[1], -std::log1p(-c.expected)) << name;
    const RiskModel without = modelOf(emptyMap(kRow, 1.0), {}, params);
    EXPECT_EQ(without.localeRisk(c.element, 1), 0.0) << name;
  }
}

TEST(RiskModel, SingularityIsSeenFromTheReel) {
  RiskParams params = nothingOn();
  params.singularity.member = {0.3, 90.0, 60.0};
  VoxelMap map = emptyMap({3, 4, 1}, 1.0);
  map.reel = map.centre(map.shape.index({0, 0, 0}));
  const RiskModel model = modelOf(map, {}, params);
  const auto risk = [&](int x, int y) {
    return model.localeRisk(RiskElement::kSingularity, map.shape.index({x, y, 0}));
  };
  EXPECT_EQ(risk(0, 0), 0.0);  // the reel itself
  EXPECT_DOUBLE_EQ(risk(0, 3), 0.3);
  EXPECT_NEAR(risk(1, 3), 0.3 * (std::atan(3.0) * 180.0 / std::numbers::pi - 60.0) / 30.0, 1e-14);
  EXPECT_EQ(risk(2, 1), 0.0);
  map.reel.reset();
  EXPECT_EQ(modelOf(map, {}, params).costs().locale[6], 0.0);
}

TEST(RiskModel, LayersOutsideTheirDomainAreRefused) {
  EXPECT_EQ(problemOf(rowWithLayer("surface", {0.0, 1.5, 0.0})).key, "surface");
  EXPECT_THAT(problemOf(rowWithLayer("surface", {0.0, 1.5, 0.0})).problem, HasSubstr("1.5"));
  EXPECT_THAT(problemOf(rowWithLayer("surface", {0.0, 1.5, 0.0})).problem, HasSubstr("(1, 0, 0)"));
  EXPECT_EQ(problemOf(rowWithLayer("slippage", {0.0, 0.0, -0.1})).allowed, "0 to 1");
  EXPECT_EQ(problemOf(rowWithLayer("surface", {0.0, std::nan(""), 0.0})).key, "surface");
  EXPECT_THAT(problemOf(rowWithLayer("surface", {0.0})).problem, HasSubstr("1 values"));
  EXPECT_THAT(problemOf(rowWithLayer("surfaces", {0, 0, 0})).allowed,
              HasSubstr("terrain_stability, surface, slippage"));
}

TEST(RiskModel, NeededFieldsEndWhereTheRiskEnds) {
  const VoxelMap map = emptyMap(kRow, 0.25);
  const FieldRequest none = neededFields(nothingOn(), map);
  EXPECT_FALSE(none.distance || none.width || none.visibility);

  RiskParams params;
  params.distance.member.none = 1.5;
  params.distance.tolerance = 0.3;
  params.visibility.directions = 20;
  params.visibility.cap = 6.0;
  FieldRequest request = neededFields(params, map);
  EXPECT_TRUE(request.distance && request.visibility);
  EXPECT_FALSE(request.width);
  EXPECT_DOUBLE_EQ(request.distance_cap, 2.05);
  EXPECT_EQ(request.visibility_directions, 20);
  EXPECT_EQ(request.visibility_cap, 6.0);

  params = nothingOn();
  params.scale = {{0.2, 1.0, 2.5}, 0.4, true};
  request = neededFields(params, map);
  EXPECT_TRUE(request.width);
  EXPECT_FALSE(request.visibility);
  EXPECT_DOUBLE_EQ(request.width_cap, 1.25);
  params.access.per_unit = 0.1;
  EXPECT_DOUBLE_EQ(neededFields(params, map).width_cap, FieldRequest{}.width_cap);
  params.access.character = AccessCharacter::kVisibility;
  EXPECT_TRUE(neededFields(params, map).visibility);
  EXPECT_DOUBLE_EQ(neededFields(params, map).width_cap, 1.25);
}

TEST(RiskModel, TetherElementsNeedAString) {
  RiskParams params = nothingOn();
  params.contacts.each = 0.1;
  EXPECT_FALSE(modelOf(emptyMap(kRow, 1.0), {}, params).hasTether());
  EXPECT_TRUE(modelOf(emptyMap(kRow, 1.0), {}, params).enabled().empty());
  const auto string =
      std::make_shared<PolesString>(Eigen::Vector3d(0.5, 0.5, 0.5), std::vector<Eigen::Vector3d>{});
  EXPECT_TRUE(modelOf(emptyMap(kRow, 1.0), {}, params, string).hasTether());
  EXPECT_FALSE(modelOf(emptyMap(kRow, 1.0), {}, nothingOn(), string).hasTether());
  for (const int limit : {0, 1, 2}) {
    RiskParams limited = nothingOn();
    if (limit == 0) limited.tether_limits.length_max = 9.0;
    if (limit == 1) limited.tether_limits.contacts_max = 0;
    if (limit == 2) limited.tether_limits.elevation_min = -10.0;
    EXPECT_TRUE(modelOf(emptyMap(kRow, 1.0), {}, limited, string).hasTether()) << limit;
  }
  VoxelMap sharp = emptyMap(kRow, 1.0);
  sharp.no_contact.assign(sharp.shape.size(), 1);
  EXPECT_TRUE(modelOf(sharp, {}, nothingOn(), string).hasTether());
}

TEST(RiskModel, TellsWhichLimitsAreBroken) {
  const auto string = std::make_shared<PolesString>(Eigen::Vector3d(0.5, 0.5, 0.5),
                                                    std::vector<Eigen::Vector3d>{{1.5, 0.5, 0.5}});
  RiskParams params = nothingOn();
  EXPECT_FALSE(modelOf(emptyMap(kRow, 1.0), {}, params, string).brokenLimits(1, {9, 0, 0}).any());
  params.tether_limits = {3.0, 0, -10.0};
  string->forbidBeyond(0);
  const RiskModel model = modelOf(emptyMap(kRow, 1.0), {}, params, string);
  EXPECT_FALSE(model.brokenLimits(0, {3.0, 0.5, 0.5}).any());
  const BrokenLimits far = model.brokenLimits(0, {9.0, 0.5, 0.5});
  EXPECT_TRUE(far.length && !far.contacts && !far.elevation && !far.no_contact);
  const BrokenLimits low = model.brokenLimits(1, {2.5, -1.0, 0.5});
  EXPECT_TRUE(!low.length && low.contacts && low.elevation && low.no_contact);
}

TEST(RiskModel, TetherCost) {
  RiskParams params = nothingOn();
  params.tether_length.per_metre = 0.01;
  params.contacts.each = 0.03;
  params.tether_limits.length_max = 8.0;
  params.tether_limits.contacts_max = 2;
  const RiskModel model = modelOf(emptyMap(kRow, 1.0), {}, params);
  EXPECT_NEAR(model.tetherCost(5.0, 2), -std::log(0.95 * 0.94), 1e-15);
  EXPECT_EQ(model.tetherCost(8.1, 0), kInfinity);
  EXPECT_EQ(model.tetherCost(1.0, 3), kInfinity);
}

TEST(RiskModel, WhatAPathPaysForItsStates) {
  RiskParams params = nothingOn();
  const RiskModel per_state = modelOf(emptyMap(kRow, 1.0), {}, params);
  EXPECT_EQ(per_state.overStep(0.1, 0.3, 7.0), 0.3);
  EXPECT_EQ(per_state.startShare(0.3), 0.3);
  EXPECT_EQ(per_state.startShare(kInfinity), kInfinity);
  params.mode = RiskMode::kRate;
  params.reference_step = 0.5;
  const RiskModel rate = modelOf(emptyMap(kRow, 1.0), {}, params);
  EXPECT_DOUBLE_EQ(rate.overStep(0.1, 0.3, 0.25), 0.1);
  EXPECT_EQ(rate.overStep(0.1, kInfinity, 0.25), kInfinity);
  EXPECT_EQ(rate.startShare(0.3), 0.0);
  EXPECT_EQ(rate.startShare(kInfinity), kInfinity);
}

TEST(RiskModel, LeastElevation) {
  RiskParams params = nothingOn();
  const Eigen::Vector3d anchor(0, 2, 0);
  EXPECT_TRUE(modelOf(emptyMap(kRow, 1.0), {}, params).elevationAllowed(anchor, {0, 0, 0}));
  params.tether_limits.elevation_min = 30.0;
  const RiskModel model = modelOf(emptyMap(kRow, 1.0), {}, params);
  EXPECT_TRUE(model.elevationAllowed(anchor, {1.0, 2.58, 0}));
  EXPECT_FALSE(model.elevationAllowed(anchor, {1.0, 2.57, 0}));
  EXPECT_TRUE(model.elevationAllowed(anchor, anchor));
}

TEST(RiskModel, AccessIsRiskyOneWayOnly) {
  RiskParams params = nothingOn();
  params.access.per_unit = 0.1;
  MapFields fields;
  fields.width = {3.0F, 1.0F, 2.0F};
  const RiskModel model = modelOf(emptyMap(kRow, 1.0), fields, params);
  EXPECT_DOUBLE_EQ(model.accessCost(0, 1), -std::log(0.8));
  EXPECT_EQ(model.accessCost(1, 0), 0.0);
  EXPECT_EQ(model.accessCost(1, 1), 0.0);
  EXPECT_EQ(modelOf(emptyMap(kRow, 1.0), {}, nothingOn()).accessCost(0, 1), 0.0);
}

TEST(RiskModel, MudAndEnergyGather) {
  RiskParams params = nothingOn();
  params.slippage.per_mud = 0.2;
  params.battery = {{0.5, 1.0, 0.0}, 10.0, 1.0};
  const RiskModel model = modelOf(rowWithLayer("slippage", {0.5, 0.25, 1.0}), {}, params);
  ASSERT_TRUE(model.hasAccumulators());
  const Accumulators one = model.advance({}, 0, 1, 1.0);
  EXPECT_DOUBLE_EQ(one.mud, 0.5);
  EXPECT_DOUBLE_EQ(one.energy, 0.1);
  EXPECT_NEAR(model.accumulatorCost(one, 1), -std::log((1 - 0.025) * (1 - 0.05)), 1e-15);
  const Accumulators two = model.advance(one, 1, 2, 1.0);
  EXPECT_DOUBLE_EQ(two.mud, 0.75);
  EXPECT_NEAR(model.accumulatorCost(two, 2), -std::log((1 - 0.15) * (1 - 0.1)), 1e-15);

  params.mode = RiskMode::kRate;
  params.reference_step = 0.5;
  const RiskModel rate = modelOf(rowWithLayer("slippage", {0.5, 0.25, 1.0}), {}, params);
  const Accumulators after = rate.advance({}, 0, 1, 1.0);
  EXPECT_DOUBLE_EQ(after.mud, (0.5 + 0.25) / 2.0 / 0.5);
  EXPECT_DOUBLE_EQ(after.energy, 0.1);
  EXPECT_FALSE(modelOf(emptyMap(kRow, 1.0), {}, nothingOn()).hasAccumulators());
}

TEST(RiskModel, TurnTableHasNoTurnAtTheStartNorStraightOn) {
  RiskParams params = nothingOn();
  params.turn = {TurnLaw::kLinear, 0.05, 0.7, 12.0};
  const RiskModel model = modelOf(emptyMap(kRow, 0.4), {}, params);
  const auto& turn = model.costs().turn;
  for (std::size_t d = 0; d < kDirections; ++d) {
    EXPECT_EQ(turn[kNoDirection][d], 0.0);
    EXPECT_EQ(turn[d][d], 0.0);
    const auto back = static_cast<std::size_t>(opposite(static_cast<Direction>(d)));
    const double length = 0.4 * stepLength(static_cast<Direction>(d));
    EXPECT_NEAR(turn[d][back], -std::log1p(-0.05 * 2.0 * length), 1e-15);
  }
}

}  // namespace
}  // namespace tautline::planning
