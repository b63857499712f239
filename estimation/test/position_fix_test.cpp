#include "estimation/position_fix.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "common/testing/catenary_oracle.h"
#include "estimation/test/golden.h"

namespace tautline {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kTetherWeight = 0.0061 * 9.81;

void expectLiteral(const PublishedCatenary& got, const golden::Literal& want) {
  EXPECT_NEAR(got.L_x, want.L_x, 1e-10 * std::fmax(1.0, want.L_x));
  EXPECT_NEAR(got.L_y, want.L_y, 1e-10 * std::fmax(1.0, want.L_y));
  EXPECT_NEAR(got.theta_r, want.theta_r, 1e-11);
  EXPECT_NEAR(got.L_r, want.L_r, 1e-10 * std::fmax(1.0, want.L_r));
  EXPECT_NEAR(got.L_s, want.L_s, 1e-10 * std::fmax(1.0, want.L_s));
}

TEST(PublishedCatenary, AgreesWithTheReferenceInBothReadings) {
  for (const golden::LiteralCase& c : golden::loadLiteral()) {
    expectLiteral(publishedCatenary(c.theta, c.T * std::cos(c.theta), c.w), c.horizontal);
    expectLiteral(publishedCatenary(c.theta, c.T, c.w), c.as_stated);
  }
}

TEST(PublishedCatenary, ItsCorrectionIsScaleFree) {
  // Neither tension nor tether weight nor length changes the corrected angle: it is a fixed
  // function of the sensed one.
  const struct {
    double sensed, corrected;
  } table[] = {{5, 2.50},   {15, 7.59},  {30, 15.73}, {45, 25.17},
               {60, 37.21}, {75, 54.70}, {85, 73.36}};
  for (const auto& row : table) {
    const double theta = row.sensed * kDegree;
    const double reference = publishedCatenary(theta, 1.0, 1.0).theta_r;
    EXPECT_NEAR(reference / kDegree, row.corrected, 0.005);
    EXPECT_NEAR(reference, std::atan((1.0 / std::cos(theta) - 1.0) / std::asinh(std::tan(theta))),
                1e-14);
    for (const double T_0 : {0.01, 0.2, 1.0, 3.0, 1000.0}) {
      for (const double w : {1e-4, kTetherWeight, 2.0}) {
        EXPECT_NEAR(publishedCatenary(theta, T_0, w).theta_r, reference, 1e-15);
      }
    }
    for (const double L : {0.1, 1.0, 10.0}) {
      for (const double T : {0.2, 3.0}) {
        const PositionFix fix =
            fixPosition(FixVariant::kAsPublishedCode, {L, theta, 0.0, T, kTetherWeight});
        EXPECT_NEAR(std::atan2(fix.p_AD.y(), fix.p_AD.z()), reference, 1e-14);
        EXPECT_NEAR(fix.p_AD.norm(), L, 1e-14 * L);
      }
    }
  }
}

TEST(PublishedCatenary, IsExactOnlyForATetherThatIsLevelAtTheReel) {
  const double theta = 45 * kDegree;
  const double T = 0.212;  // T sin(theta) = w L for 2.5 m
  const double L = T * std::sin(theta) / kTetherWeight;
  const auto exact = fixPosition(FixVariant::kExact, {L, theta, 0.3, T, kTetherWeight});
  const PublishedCatenary level = publishedCatenary(theta, T * std::cos(theta), kTetherWeight);
  EXPECT_NEAR(level.L_s, L, 1e-12);
  EXPECT_NEAR(level.L_r, exact.p_AD.norm(), 1e-12);
  const auto taut = fixPosition(FixVariant::kExact, {2.5, theta, 0.3, 3.0, kTetherWeight});
  const auto published =
      fixPosition(FixVariant::kAsPublishedCode, {2.5, theta, 0.3, 3.0, kTetherWeight});
  EXPECT_GT((taut.p_AD - published.p_AD).norm(), 0.7);
}

TEST(PublishedCatenary, TextVariantPutsAShortTetherFarAway) {
  // 2.5 m of tether at 1 N and 45 deg is "located" by the model's own length, T_0 = T: 16 m from
  // the reel.
  const auto fix =
      fixPosition(FixVariant::kAsPublishedText, {2.5, 45 * kDegree, 0.0, 1.0, kTetherWeight});
  ASSERT_TRUE(fix.ok);
  EXPECT_NEAR(fix.p_AD.norm(), 16.3, 0.05);
}

TEST(PublishedCatenary, IsOddAndFiniteAtItsLimits) {
  EXPECT_EQ(publishedCatenary(0.0, 1.0, 1.0).theta_r, 0.0);
  EXPECT_NEAR(publishedCatenary(1e-9, 1.0, 1.0).theta_r, 0.5e-9, 1e-24);
  EXPECT_DOUBLE_EQ(publishedCatenary(-0.7, 1.0, 1.0).theta_r,
                   -publishedCatenary(0.7, 1.0, 1.0).theta_r);
  EXPECT_NEAR(publishedCatenary(kPi / 2, 1.0, 1.0).theta_r, kPi / 2, 1e-12);
}

TEST(PositionFix, ExactIsWhereTheForceBalancePutsTheDrone) {
  for (const double theta : {-20 * kDegree, 15 * kDegree, 60 * kDegree, 88 * kDegree}) {
    const FixInput in{4.0, theta, 2.1, 0.6, kTetherWeight};
    const PositionFix fix = fixPosition(FixVariant::kExact, in);
    ASSERT_TRUE(fix.ok);
    const testing::TetherEnd want = testing::integrateTether(in.L, theta, in.T, in.w);
    EXPECT_NEAR(fix.p_AD.x(), want.r * std::sin(in.phi), 1e-12);
    EXPECT_NEAR(fix.p_AD.y(), want.h, 1e-12);
    EXPECT_NEAR(fix.p_AD.z(), want.r * std::cos(in.phi), 1e-12);
  }
}

TEST(PositionFix, ExactApproachesStraightWithTension) {
  const auto straight = fixPosition(FixVariant::kStraight, {3.0, 0.6, 1.0, 0.0, 0.0});
  ASSERT_TRUE(straight.ok);
  double last = 1e9;
  for (const double T : {0.3, 1.0, 10.0, 1e3, 1e6}) {
    const auto exact = fixPosition(FixVariant::kExact, {3.0, 0.6, 1.0, T, kTetherWeight});
    const double gap = (exact.p_AD - straight.p_AD).norm();
    EXPECT_LT(gap, last);
    last = gap;
  }
  EXPECT_LT(last, 1e-6);
}

TEST(PositionFix, RefusesInputOutsideItsDomain) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto& entry : kFixVariantNames) {
    EXPECT_TRUE(fixPosition(entry.value, {3.0, 0.6, 1.0, 0.5, kTetherWeight}).ok) << entry.name;
    EXPECT_FALSE(fixPosition(entry.value, {nan, 0.6, 1.0, 0.5, kTetherWeight}).ok) << entry.name;
    EXPECT_FALSE(fixPosition(entry.value, {-1.0, 0.6, 1.0, 0.5, kTetherWeight}).ok) << entry.name;
    EXPECT_FALSE(fixPosition(entry.value, {3.0, 1.7, 1.0, 0.5, kTetherWeight}).ok) << entry.name;
    EXPECT_FALSE(fixPosition(entry.value, {3.0, 0.6, nan, 0.5, kTetherWeight}).ok) << entry.name;
  }
  EXPECT_FALSE(fixPosition(FixVariant::kExact, {3.0, 0.6, 1.0, 0.0, kTetherWeight}).ok);
  EXPECT_FALSE(fixPosition(FixVariant::kAsPublishedText, {3.0, 0.6, 1.0, -1.0, kTetherWeight}).ok);
  EXPECT_FALSE(fixPosition(FixVariant::kAsPublishedText, {3.0, 0.6, 1.0, 1.0, 0.0}).ok);
}

}  // namespace
}  // namespace tautline
