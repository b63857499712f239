// Properties of single updates of the control laws; whole flights are in flight_test.cpp.

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "common/catenary.h"
#include "control/control_config.h"

namespace tautline {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(10);
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<ControlConfig> allLaws() {
  std::vector<ControlConfig> out;
  for (const auto& law : kLawNames) {
    ControlConfig c;
    c.law = law.value;
    out.push_back(c);
  }
  out.emplace_back().composite.pole_strategy = PoleStrategy::kUnwrapped;
  out.emplace_back().composite.feed_forward.model = TetherModel::kCatenary;
  out.emplace_back().law = Law::kPosition;
  out.back().position.target.model = TetherModel::kCatenary;
  out.back().position.length_law = LengthLaw::kBangBang;
  out.emplace_back().law = Law::kVelocity;
  out.back().velocity.total_length = true;
  return out;
}

ControlInput input(const Eigen::Vector3d& p_WD, const Eigen::Vector3d& p_WS,
                   const Eigen::Vector3d& p_WE) {
  ControlInput in;
  in.estimate.valid = true;
  in.estimate.health = EstimateHealth::kOk;
  in.estimate.P_position = 1e-4 * Eigen::Matrix3d::Identity();
  in.estimate.T = 0.5;
  in.estimate.p_WD = p_WD;
  in.p_WS = p_WS;
  in.p_WE = p_WE;
  return in;
}

Eigen::Vector3d velocityOf(const RateCommand& u, const Eigen::Vector3d& p_AD) {
  return velocityFromRates(toTether(p_AD), {u.length_rate, u.elevation_rate, u.azimuth_rate});
}

/// Bare composite law: no look-ahead in time, so that its Jacobian is the one at p.
ControlConfig withoutLag() {
  ControlConfig c;
  c.composite.vehicle_lag_s = 0.0;
  return c;
}

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

bool atRest(const RateCommand& u) {
  return u.length_rate == 0.0 && u.elevation_rate == 0.0 && u.azimuth_rate == 0.0;
}

TEST(ControlLaws, TheFactoryMakesTheLawThatWasAskedFor) {
  for (const auto& law : kLawNames) {
    ControlConfig c;
    c.law = law.value;
    EXPECT_STREQ(makeController(c)->name(), law.name);
  }
}

TEST(ControlLaws, RefuseWhatCannotBeActedOn) {
  const ControlInput good = input({1, 1, 1}, {1, 1, 1}, {2, 1, 1});
  std::vector<ControlInput> bad(10, good);
  bad[0].estimate.valid = false;
  bad[1].estimate.health = EstimateHealth::kLost;
  bad[2].estimate.p_WD.x() = kNan;
  bad[3].p_WS.y() = kNan;
  bad[4].p_WE.z() = std::numeric_limits<double>::infinity();
  bad[5].p_WN = Eigen::Vector3d::Constant(kNan);
  bad[6].anchor.p_WA.x() = kNan;
  bad[7].speed = kNan;
  bad[8].speed = 0.0;
  bad[9].estimate.v_WD.x() = kNan;
  for (const ControlConfig& config : allLaws()) {
    const auto law = makeController(config);
    EXPECT_TRUE(law->update(kStep, good).ok);
    for (const ControlInput& in : bad) {
      const RateCommand u = law->update(kStep, in);
      EXPECT_FALSE(u.ok);
      EXPECT_TRUE(atRest(u));
    }
    EXPECT_TRUE(law->update(kStep, good).ok);  // and it recovers
  }
}

TEST(ControlLaws, AreFiniteAndWithinTheLimitsEverywhere) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> box(-3.0, 3.0);
  const auto point = [&] { return Eigen::Vector3d(box(random), box(random), box(random)); };
  std::vector<Eigen::Vector3d> positions{{0, 0, 0},          {0, 1, 0},     {0, -1, 0},
                                         {1e-9, 2, 0},       {0, -2, 1e-7}, {1e-12, 0, 0},
                                         {1e-300, 1e-300, 0}};
  for (int i = 0; i < 300; ++i) positions.push_back(point());
  for (const ControlConfig& config : allLaws()) {
    const auto law = makeController(config);
    for (const Eigen::Vector3d& p : positions) {
      for (const Eigen::Vector3d& end : {point(), p, Eigen::Vector3d(0, 1.5, 0)}) {
        ControlInput in = input(p, point(), end);
        if (p.x() > 1.0) in.p_WN = point();
        const RateCommand u = law->update(kStep, in);
        ASSERT_TRUE(u.ok);
        ASSERT_LE(std::abs(u.length_rate), in.limits.length_rate_mps * (1 + 1e-12));
        ASSERT_LE(std::abs(u.elevation_rate), in.limits.elevation_rate_radps * (1 + 1e-12));
        ASSERT_LE(std::abs(u.azimuth_rate), in.limits.azimuth_rate_radps * (1 + 1e-12));
      }
    }
  }
}

TEST(CompositeLaw, KeepsTheDirectionWhenALimitIsHit) {
  // Fast, close, sideways: the azimuth rate saturates many times over.
  const Eigen::Vector3d p(0.0, 0.5, 0.8);
  ControlInput in = input(p, p, {3.0, 1.5, 0.8});
  in.p_WN = in.p_WE;
  in.speed = 1.0;
  const RateCommand u = makeController(withoutLag())->update(kStep, in);
  ASSERT_TRUE(u.ok);
  EXPECT_NEAR(u.azimuth_rate, in.limits.azimuth_rate_radps, 1e-12);
  EXPECT_NEAR(angleBetween(velocityOf(u, p), in.p_WE - p), 0.0, 1e-9);

  // The published law leaves the line in the same place.
  ControlConfig published;
  published.law = Law::kVelocity;
  published.velocity.speed_mps = 1.0;
  const RateCommand bent = makeController(published)->update(kStep, in);
  EXPECT_GT(angleBetween(velocityOf(bent, p), in.p_WE - p), 0.3);
}

TEST(CompositeLaw, OnTheLineItFliesAlongItWithTheGivenSpeed) {
  const Eigen::Vector3d a(-1.0, 1.0, 1.5), b(1.0, 2.0, 2.0);
  ControlInput in = input(a + 0.3 * (b - a), a, b);
  in.limits.azimuth_rate_radps = 1.0;
  in.limits.elevation_rate_radps = 1.0;
  const RateCommand u = makeController(withoutLag())->update(kStep, in);
  EXPECT_TRUE(velocityOf(u, in.estimate.p_WD).isApprox(0.3 * (b - a).normalized(), 1e-9));
}

TEST(CompositeLaw, BesideTheLineItComesBackToItAndStillGoesOn) {
  const Eigen::Vector3d a(-1.0, 1.0, 1.5), b(1.0, 1.0, 1.5);
  for (const Eigen::Vector3d& off : {Eigen::Vector3d(0, 0.2, 0), Eigen::Vector3d(0, 0, -0.2)}) {
    const ControlInput in = input(Eigen::Vector3d(0, 1, 1.5) + off, a, b);
    const Eigen::Vector3d v =
        velocityOf(makeController(withoutLag())->update(kStep, in), in.estimate.p_WD);
    EXPECT_LT(v.dot(off), 0.0);
    EXPECT_GT(v.x(), 0.0);
  }
}

TEST(CompositeLaw, SlowsDownBeforeAStopButNotBeforeAWaypointOnTheWay) {
  const Eigen::Vector3d a(-1.0, 1.0, 1.5), b(1.0, 1.0, 1.5);
  ControlInput in = input({0.9, 1.0, 1.5}, a, b);
  in.limits.azimuth_rate_radps = 1.0;
  const auto law = makeController(withoutLag());
  EXPECT_NEAR(velocityOf(law->update(kStep, in), in.estimate.p_WD).norm(), 0.06, 1e-9);
  in.p_WN = Eigen::Vector3d(2.0, 1.0, 1.5);
  EXPECT_NEAR(velocityOf(law->update(kStep, in), in.estimate.p_WD).norm(), 0.3, 1e-9);
  in = input(b, b, b);
  EXPECT_TRUE(atRest(law->update(kStep, in)));
}

TEST(CompositeLaw, IsTheSameForEveryAzimuthAndMirrored) {
  const Eigen::Vector3d a(0.2, 1.0, 1.5), b(-1.0, 1.6, 1.0), p(-0.1, 1.1, 1.3);
  const auto law = makeController(ControlConfig{});
  const RateCommand u = law->update(kStep, input(p, a, b));
  for (double turn = -3.1; turn < 3.2; turn += 0.1) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()).toRotationMatrix();
    const RateCommand turned = law->update(kStep, input(R * p, R * a, R * b));
    EXPECT_NEAR(turned.length_rate, u.length_rate, 1e-12);
    EXPECT_NEAR(turned.elevation_rate, u.elevation_rate, 1e-12);
    EXPECT_NEAR(turned.azimuth_rate, u.azimuth_rate, 1e-12);
  }
  const Eigen::DiagonalMatrix<double, 3> M(-1.0, 1.0, 1.0);
  const RateCommand mirrored = law->update(kStep, input(M * p, M * a, M * b));
  EXPECT_NEAR(mirrored.length_rate, u.length_rate, 1e-12);
  EXPECT_NEAR(mirrored.elevation_rate, u.elevation_rate, 1e-12);
  EXPECT_NEAR(mirrored.azimuth_rate, -u.azimuth_rate, 1e-12);
}

TEST(PositionLaw, TakesTheShortWayRoundAcross180Degrees) {
  ControlConfig c;
  c.law = Law::kPosition;
  const auto at = [](double degrees) {
    const double a = degrees * std::numbers::pi / 180.0;
    return Eigen::Vector3d(2.0 * std::sin(a), 1.0, 2.0 * std::cos(a));
  };
  const auto law = makeController(c);
  EXPECT_NEAR(law->update(kStep, input(at(170), at(170), at(-170))).azimuth_rate,
              0.2 * 20.0 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_NEAR(law->update(kStep, input(at(-170), at(-170), at(170))).azimuth_rate,
              -0.2 * 20.0 * std::numbers::pi / 180.0, 1e-12);
}

TEST(PositionLaw, DampingOpposesTheMotion) {
  ControlConfig c;
  c.law = Law::kPosition;
  ControlInput in = input({0, 1, 2}, {0, 1, 2}, {0, 1, 2});
  in.estimate.v_WD = Eigen::Vector3d(0.1, 0.1, 0.1);
  EXPECT_TRUE(atRest(makeController(c)->update(kStep, in)));
  c.position.damping = 0.5;
  const RateCommand u = makeController(c)->update(kStep, in);
  EXPECT_TRUE(velocityOf(u, in.estimate.p_WD).isApprox(-0.5 * in.estimate.v_WD, 1e-9));
}

TEST(PositionLaw, WithTheCatenaryItAsksForTheLengthAndTangentOfTheTarget) {
  ControlConfig c;
  c.law = Law::kPosition;
  c.position.target.model = TetherModel::kCatenary;
  const Eigen::Vector3d p(0, 1, 2), target(0, 1.1, 2.2);
  const RateCommand u = makeController(c)->update(kStep, input(p, p, target));
  const CatenaryInverse here = solveInverseCatenary(2.0, 1.0, 0.5, 0.059841);
  const CatenaryInverse there = solveInverseCatenary(2.2, 1.1, 0.5, 0.059841);
  EXPECT_NEAR(u.length_rate, 0.5 * (there.L - here.L), 1e-12);
  EXPECT_NEAR(u.elevation_rate, 0.25 * (there.theta_D - here.theta_D), 1e-12);
  EXPECT_GT(std::abs(u.elevation_rate), 1e-4);  // straight: none at all
}

TEST(CompositeLaw, CatenaryFeedForwardMovesTheDroneAlongTheLine) {
  // Oracle: arc length and tangent at the rates' own end give back the position through the forward
  // model.
  ControlConfig c = withoutLag();
  c.composite.feed_forward.model = TetherModel::kCatenary;
  ControlInput in = input({0, 1, 2}, {0, 1, 2}, {0.5, 1.6, 2.8});
  in.p_WN = in.p_WE;
  const RateCommand u = makeController(c)->update(kStep, in);
  const CatenaryInverse q = solveInverseCatenary(2.0, 1.0, 0.5, 0.059841);
  constexpr double kTime = 1e-3;
  const CatenarySolution end = solveCatenary({.L = q.L + kTime * u.length_rate,
                                              .theta_D = q.theta_D + kTime * u.elevation_rate,
                                              .T_D = 0.5,
                                              .w = 0.059841});
  const double phi = kTime * u.azimuth_rate;
  const Eigen::Vector3d moved =
      Eigen::Vector3d(end.r * std::sin(phi), end.h, end.r * std::cos(phi)) - in.estimate.p_WD;
  EXPECT_LT(angleBetween(moved, in.p_WE - in.p_WS), 1e-3);
}

TEST(VelocityLaw, UsesTheFreeLengthUnlessToldOtherwise) {
  ControlConfig c;
  c.law = Law::kVelocity;
  ControlInput in = input({0, 2.0, 2.0}, {0, 2.0, 2.0}, {0, 3.0, 2.0});
  in.anchor = {.p_WA = {0, 2.0, 0}, .L_static = 2.0, .contact_count = 1};
  in.p_WN = in.p_WE;
  EXPECT_NEAR(makeController(c)->update(kStep, in).elevation_rate, 0.1 / 2.0, 1e-12);
  c.velocity.total_length = true;  // half the rate: the published code's defect behind a contact
  EXPECT_NEAR(makeController(c)->update(kStep, in).elevation_rate, 0.1 / 4.0, 1e-12);
}

TEST(ControlLaws, LowerTheDroneBelowAContactAboveIt) {
  ControlInput in = input({0.5, 1.0, 1.0}, {0.5, 1.0, 1.0}, {0.5, 0.4, 1.0});
  in.anchor = {.p_WA = {0.0, 2.0, 0.0}, .L_static = 2.0, .contact_count = 1};
  in.p_WN = in.p_WE;
  for (const ControlConfig& config : allLaws()) {
    const RateCommand u = makeController(config)->update(kStep, in);
    ASSERT_TRUE(u.ok);
    EXPECT_GT(u.length_rate, 0.0);
    EXPECT_LT(u.elevation_rate, 0.0);
  }
}

}  // namespace
}  // namespace tautline
