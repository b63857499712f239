#include "planning_offline/risk/element_laws.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "planning_offline/risk/risk_report.h"

namespace tautline::planning {
namespace {

TEST(ElementLaws, MembershipsFallAndRiseLinearlyBetweenTheirEnds) {
  RiskParams params;
  params.distance.member = {0.1, 0.2, 1.2};
  EXPECT_DOUBLE_EQ(distanceRisk(params, 0.0), 0.1);
  EXPECT_DOUBLE_EQ(distanceRisk(params, 0.2), 0.1);
  EXPECT_DOUBLE_EQ(distanceRisk(params, 0.45), 0.075);
  EXPECT_DOUBLE_EQ(distanceRisk(params, 1.2), 0.0);
  EXPECT_DOUBLE_EQ(distanceRisk(params, 50.0), 0.0);
  params.distance.tolerance = 0.25;
  EXPECT_DOUBLE_EQ(distanceRisk(params, 0.7), 0.075);

  params.singularity.member = {0.2, 90.0, 70.0};
  EXPECT_DOUBLE_EQ(singularityRisk(params, std::numbers::pi / 2.0), 0.2);
  EXPECT_NEAR(singularityRisk(params, 75.0 * std::numbers::pi / 180.0), 0.05, 1e-15);
  EXPECT_DOUBLE_EQ(singularityRisk(params, -1.0), 0.0);

  params.battery.member = {0.4, 1.0, 0.5};
  EXPECT_DOUBLE_EQ(batteryRisk(params, 0.5), 0.0);
  EXPECT_DOUBLE_EQ(batteryRisk(params, 0.75), 0.2);
  EXPECT_DOUBLE_EQ(batteryRisk(params, 3.0), 0.4);
}

TEST(ElementLaws, ScaleForbidsWhatIsGranular) {
  RiskParams params;
  params.scale.member = {0.3, 1.0, 2.5};
  params.scale.agent_dimension = 0.4;
  EXPECT_EQ(scaleRisk(params, 0.4), 1.0);
  EXPECT_EQ(scaleRisk(params, static_cast<double>(0.4F)), 1.0);  // as the field stores it
  EXPECT_NEAR(scaleRisk(params, 0.41), 0.3 * (2.5 - 1.025) / 1.5, 1e-15);
  EXPECT_DOUBLE_EQ(scaleRisk(params, 1.0), 0.0);
  params.scale.forbid_granular = false;
  EXPECT_DOUBLE_EQ(scaleRisk(params, 0.1), 0.3);
}

TEST(ElementLaws, ThreatGrowsWithDwell) {
  RiskParams params;
  params.dynamic_threat.dwell = 2.0;
  EXPECT_NEAR(threatRisk(params, 0.1), 1.0 - 0.9 * 0.9, 1e-15);
  EXPECT_NEAR(threatRisk(params, 1e-12), 2e-12, 1e-20);
  EXPECT_EQ(threatRisk(params, 0.0), 0.0);
  EXPECT_EQ(threatRisk(params, 1.0), 1.0);
}

TEST(ElementLaws, CertainLocaleForbidsAndEverythingElseIsCapped) {
  RiskParams params;
  params.distance.member.risk = 1.0;
  params.visibility.member.risk = 0.97;
  EXPECT_EQ(distanceRisk(params, 0.0), 1.0);
  EXPECT_EQ(visibilityRisk(params, 0.0), 0.95);
  EXPECT_EQ(layerRisk(params, LayerParams{1.0}, 1.0), 1.0);
  EXPECT_EQ(layerRisk(params, LayerParams{0.99}, 1.0), 0.95);
  params.battery.member.risk = 1.0;
  EXPECT_EQ(batteryRisk(params, 1.0), 1.0);

  params.action_length.per_metre = params.turn.risk = params.access.per_unit = 10.0;
  params.tether_length.per_metre = params.contacts.each = 1.0;
  params.slippage.per_mud = 10.0;
  EXPECT_EQ(actionLengthRisk(params, 1.0), 0.95);
  EXPECT_EQ(turnRisk(params, {1, 0, 0}, {0, 1, 0}), 0.95);
  EXPECT_EQ(accessRisk(params, 1.0), 0.95);
  EXPECT_EQ(tetherLengthRisk(params, 5.0), 0.95);
  EXPECT_EQ(contactsRisk(params, 2), 0.95);
  EXPECT_EQ(slippageRisk(params, 3.0, 1.0), 0.95);
}

TEST(ElementLaws, NothingCertainIsLostToTheQuantumNorGained) {
  RiskParams params;
  params.quantum = 0.01;
  EXPECT_EQ(layerRisk(params, LayerParams{1.0}, 0.999), 0.95);
  EXPECT_EQ(layerRisk(params, LayerParams{1.0}, 1.0), 1.0);
}

TEST(ElementLaws, QuantumRoundsToTheNearestAndAHalfUp) {
  RiskParams params;
  params.quantum = 0.01;
  const LayerParams layer{1.0};
  EXPECT_DOUBLE_EQ(layerRisk(params, layer, 0.0349), 0.03);
  EXPECT_DOUBLE_EQ(layerRisk(params, layer, 0.035), 0.04);
  EXPECT_DOUBLE_EQ(layerRisk(params, layer, 0.035 - 1e-13), 0.04);  // a half but for rounding
  EXPECT_DOUBLE_EQ(layerRisk(params, layer, 0.0049), 0.0);
  // The published column: face, edge and corner steps of 0.4 m cells.
  EXPECT_DOUBLE_EQ(actionLengthRisk(params, 0.4), 0.04);
  EXPECT_DOUBLE_EQ(actionLengthRisk(params, 0.4 * std::sqrt(2.0)), 0.05);
  EXPECT_DOUBLE_EQ(actionLengthRisk(params, 0.4 * std::sqrt(3.0)), 0.06);
}

TEST(ElementLaws, TurnLaws) {
  RiskParams params;
  params.turn.risk = 0.05;
  const Eigen::Vector3d a(0.4, 0, 0);
  const Eigen::Vector3d diagonal(0.4, 0, 0.4);
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  for (const auto& entry : kTurnLawNames) {
    params.turn.law = entry.value;
    EXPECT_EQ(turnRisk(params, a, a), 0.0) << entry.name;
    EXPECT_EQ(turnRisk(params, none, a), 0.0) << entry.name;
    EXPECT_EQ(turnRisk(params, a, none), 0.0) << entry.name;
  }
  params.turn.law = TurnLaw::kConstant;
  EXPECT_EQ(turnRisk(params, a, diagonal), 0.05);
  EXPECT_EQ(turnRisk(params, a, -a), 0.05);
  EXPECT_EQ(turnRisk(params, a, 3.0 * a), 0.0);  // longer, not turned
  params.turn.law = TurnLaw::kLinear;
  EXPECT_NEAR(turnRisk(params, a, diagonal), 0.05 * 0.4, 1e-16);
  EXPECT_NEAR(turnRisk(params, a, -a), 0.05 * 0.8, 1e-16);
  params.turn.law = TurnLaw::kQuadratic;
  EXPECT_NEAR(turnRisk(params, a, -a), 0.05 * 0.64, 1e-16);
  params.turn.law = TurnLaw::kThreshold;
  params.turn.gentle_cosine = 0.7;
  params.turn.sharp_factor = 12.0;
  EXPECT_NEAR(turnRisk(params, a, diagonal), 0.05 * 0.4, 1e-16);  // 45°, cosine 0.707
  EXPECT_NEAR(turnRisk(params, a, {0, 0.4, 0}), 12.0 * 0.05 * 0.4 * std::sqrt(2.0), 1e-15);
}

TEST(ElementLaws, LimitsOfTheTetherForbid) {
  RiskParams params;
  params.tether_length.per_metre = 0.0;
  params.contacts.each = 0.0;
  params.tether_limits.length_max = 5.0;
  params.tether_limits.contacts_max = 2;
  EXPECT_EQ(tetherLengthRisk(params, 5.0), 0.0);
  EXPECT_EQ(tetherLengthRisk(params, 5.001), 1.0);
  EXPECT_EQ(contactsRisk(params, 2), 0.0);
  EXPECT_EQ(contactsRisk(params, 3), 1.0);
  params.tether_limits.contacts_max = 0;
  EXPECT_EQ(contactsRisk(params, 1), 1.0);
}

TEST(ElementLaws, RateModeDoesNotMindSubdivision) {
  RiskParams params;
  params.mode = RiskMode::kRate;
  params.reference_step = 0.4;
  params.access.per_unit = 0.3;
  params.turn.law = TurnLaw::kLinear;
  // A reference step has its elementary risk …
  EXPECT_NEAR(riskOfCost(actionLengthCost(params, 0.4)), 0.0911 * 0.4, 1e-15);
  // … and ten tenths of it cost the same.
  EXPECT_NEAR(10.0 * actionLengthCost(params, 0.04), actionLengthCost(params, 0.4), 1e-15);
  EXPECT_NEAR(10.0 * accessCost(params, 0.1), accessCost(params, 1.0), 1e-15);
  const Eigen::Vector3d a(0.4, 0, 0);
  const Eigen::Vector3d b(0, 0, 0.4);
  EXPECT_NEAR(turnCost(params, a, b), turnCost(params, 0.1 * a, 0.2 * b), 1e-15);
}

TEST(ElementLaws, BatteryCountsTheClimbOnly) {
  RiskParams params;
  params.battery.range = 10.0;
  params.battery.climb_factor = 3.0;
  EXPECT_DOUBLE_EQ(energyUsed(params, {3, 0, 4}), 0.5);
  EXPECT_DOUBLE_EQ(energyUsed(params, {0, 1, 0}), 0.4);
  EXPECT_DOUBLE_EQ(energyUsed(params, {0, -1, 0}), 0.1);
}

TEST(ElementLaws, Elevation) {
  EXPECT_DOUBLE_EQ(elevationOf({1, 1, 1}, {1, 5, 1}), std::numbers::pi / 2.0);
  EXPECT_DOUBLE_EQ(elevationOf({0, 0, 0}, {3, 5, 4}), std::numbers::pi / 4.0);
  EXPECT_EQ(elevationOf({1, 1, 1}, {1, 1, 1}), 0.0);
}

}  // namespace
}  // namespace tautline::planning
