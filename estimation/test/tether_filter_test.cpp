#include "estimation/tether_filter.h"

#include <cmath>
#include <numbers>
#include <tuple>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "common/testing/catenary_oracle.h"
#include "common/testing/numeric_jacobian.h"

namespace tautline {
namespace {

constexpr double kTetherWeight = 0.0061 * 9.81;

// p_AD [m] and T [N]
class SegmentSweep : public ::testing::TestWithParam<std::tuple<double, double, double, double>> {
 protected:
  Eigen::Vector3d p() const {
    const auto [x, y, z, T] = GetParam();
    return {x, y, z};
  }
  double T() const { return std::get<3>(GetParam()); }
};

TEST_P(SegmentSweep, ReachesThePoint) {
  const TetherSegment s = segmentTo(p(), T(), kTetherWeight);
  const testing::TetherEnd end = testing::integrateTether(s.L, s.theta_D, s.T, kTetherWeight);
  const Eigen::Vector3d reached(end.r * std::sin(s.phi), end.h, end.r * std::cos(s.phi));
  EXPECT_LT((reached - p()).norm(), 2e-6);
}

TEST_P(SegmentSweep, DerivativesAreThoseOfTheSolution) {
  using Input = Eigen::Matrix<double, 4, 1>;
  const TetherSegment base = segmentTo(p(), T(), kTetherWeight);
  const auto f = [&](const Input& x) {
    const TetherSegment s = segmentTo(x.head<3>(), std::exp(x(3)), kTetherWeight);
    return Eigen::Vector3d(s.L, s.theta_D, std::cos(base.theta_D) * wrapAngle(s.phi - base.phi));
  };
  Input x;
  x << p(), std::log(T());
  const auto numeric = testing::numericJacobian<3, 4>(f, x, 1e-4);
  const TetherSegment& s = base;
  EXPECT_LT((s.L_p - numeric.block<1, 3>(0, 0)).norm(), 1e-6);
  EXPECT_LT((s.theta_p - numeric.block<1, 3>(1, 0)).norm(), 1e-6);
  EXPECT_LT((s.phi_p - numeric.block<1, 3>(2, 0)).norm(), 1e-6);
  EXPECT_NEAR(s.L_log_T, numeric(0, 3), 1e-6);
  EXPECT_NEAR(s.theta_log_T, numeric(1, 3), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Grid, SegmentSweep,
                         ::testing::Combine(::testing::Values(-1.5, 0.0, 0.4, 2.0),
                                            ::testing::Values(-1.0, 0.1, 1.5),
                                            ::testing::Values(-0.5, 0.01, 1.2),
                                            ::testing::Values(0.5, 2.0)));

TEST(Segment, RaisesATensionThatCannotHoldIt) {
  const TetherSegment s = segmentTo({2.5, 2.5, 0.0}, 0.05, kTetherWeight);
  EXPECT_NEAR(s.T, 1.2 * 0.217, 1e-3);
  EXPECT_GT(s.L, std::hypot(2.5, 2.5));
}

TEST(Segment, IsFiniteAtTheAnchor) {
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1e-12, 0, 0), Eigen::Vector3d(0, -1e-300, 0)}) {
    const TetherSegment s = segmentTo(p, 0.5, kTetherWeight);
    EXPECT_NEAR(s.L, 0.05, 1e-6);
    EXPECT_TRUE(s.L_p.allFinite() && s.theta_p.allFinite() && s.phi_p.allFinite());
  }
}

TetherFilter filterAt(const Eigen::Vector3d& p, const LocalizerConfig& config = {}) {
  TetherFilter filter(config);
  filter.reset(p);
  filter.restart(p, 0.3, 0.3);
  return filter;
}

TEST(TetherFilter, PredictionDoesNotDependOnTheCycleTime) {
  const Anchor anchor;
  TetherFilter once = filterAt({1.0, 1.5, 1.0});
  TetherFilter often = once;
  once.predict(0.5, {}, anchor);
  for (int i = 0; i < 500; ++i) often.predict(0.001, {}, anchor);
  EXPECT_LT((once.x() - often.x()).norm(), 1e-9);
  EXPECT_LT((once.P() - often.P()).norm(), 1e-9);
}

TEST(TetherFilter, FollowsTheCommandedRates) {
  const Anchor anchor{.p_WA = {0.2, 0.1, -0.3}, .L_static = 1.0, .contact_count = 1};
  TetherFilter filter = filterAt({1.2, 1.6, 0.7});
  const TetherRates rates{0.1, -0.05, 0.08};
  TetherCoordinates q = toTether(filter.p() - anchor.p_WA);
  for (int i = 0; i < 1000; ++i) {
    filter.predict(0.01, rates, anchor);
    q = {q.L + 0.01 * rates.L_dot, q.theta + 0.01 * rates.theta_dot, q.phi + 0.01 * rates.phi_dot};
  }
  const Eigen::Vector3d want = anchor.p_WA + toCartesian(q);
  // Behind by the lag of the velocity, 0.4 s of it, which also lets it run wide in the turn.
  const double speed = velocityFromRates(q, rates).norm();
  EXPECT_LT((filter.p() - want).norm(), 2.0 * 0.4 * speed);
  EXPECT_LT((filter.v() - velocityFromRates(q, rates)).norm(), 0.15 * speed);
}

TEST(TetherFilter, TensionReturnsToNominal) {
  LocalizerConfig config;
  config.nominal_tension_n = 0.6;
  TetherFilter filter = filterAt({1.0, 1.0, 1.0}, config);
  const Anchor anchor;
  for (int i = 0; i < 20; ++i) filter.updateReelTension(1.5, 0.0, 1.0, anchor);
  EXPECT_GT(filter.T(), 1.2);
  filter.predict(60.0, {}, anchor);
  EXPECT_NEAR(filter.T(), 0.6, 0.01);
}

TEST(TetherFilter, CovarianceStaysSymmetricAndPositive) {
  TetherFilter filter = filterAt({1.0, 1.0, 1.0});
  const Anchor anchor;
  for (int i = 0; i < 3000; ++i) {
    filter.predict(0.01, {0.05, 0.02, -0.05}, anchor);
    const TetherSegment s = segmentTo(filter.p(), filter.T(), kTetherWeight);
    filter.updateLength(s.L, 0.05, 1.0, anchor);
    filter.updateAngles(s.theta_D, s.phi, 0.05, 1.0, anchor);
    filter.updateAltitude(filter.p().y() - 1.0, 0.05, 1.0, anchor);
    filter.updateLean(Eigen::Quaterniond::Identity(), 0.05, 1.0, anchor);
  }
  EXPECT_EQ(filter.P(), filter.P().transpose());
  const Eigen::SelfAdjointEigenSolver<TetherFilter::Covariance> eigen(filter.P());
  EXPECT_GT(eigen.eigenvalues().minCoeff(), 0.0);
}

TEST(TetherFilter, AnglesPullAcrossThePole) {
  // Estimate on one side of the vertical, readings from the other: azimuths differ by 180 deg,
  // positions by 20 cm.
  const Anchor anchor;
  TetherFilter filter = filterAt({0.1, 2.0, 0.0});
  const Eigen::Vector3d truth(-0.1, 2.0, 0.0);
  const TetherSegment s = segmentTo(truth, filter.T(), kTetherWeight);
  for (int i = 0; i < 5; ++i) {
    const Innovation innovation = filter.updateAngles(s.theta_D, s.phi, 0.0, 1.0, anchor);
    EXPECT_TRUE(innovation.accepted);
  }
  EXPECT_LT((filter.p() - truth).norm(), 0.03);
}

TEST(TetherFilter, RefusedReadingsLeaveNoTrace) {
  const Anchor anchor;
  TetherFilter filter = filterAt({1.0, 1.0, 1.0});
  for (int i = 0; i < 20; ++i) filter.updateLength(1.8, 0.0, 1.0, anchor);
  const TetherFilter::State x = filter.x();
  const TetherFilter::Covariance P = filter.P();
  const Innovation innovation = filter.updateLength(9.0, 0.0, 1.0, anchor);
  EXPECT_FALSE(innovation.accepted);
  EXPECT_GT(innovation.nis, 25.0);
  EXPECT_EQ(filter.x(), x);
  EXPECT_EQ(filter.P(), P);
}

TEST(TetherFilter, OldReadingsAreComparedWithWhereTheDroneWas) {
  const Anchor anchor;
  TetherFilter filter = filterAt({0.0, 1.0, 2.0});
  const TetherRates away{.L_dot = 0.5, .theta_dot = 0.0, .phi_dot = 0.0};
  for (int i = 0; i < 300; ++i) filter.predict(0.01, away, anchor);
  const Eigen::Vector3d then = filter.p() - 0.4 * filter.v();
  const double L_then = segmentTo(then, filter.T(), kTetherWeight).L;
  const Innovation fresh = TetherFilter(filter).updateLength(L_then, 0.0, 1.0, anchor);
  const Innovation old = TetherFilter(filter).updateLength(L_then, 0.4, 1.0, anchor);
  EXPECT_LT(old.nis, 1e-3 * fresh.nis);
}

}  // namespace
}  // namespace tautline
