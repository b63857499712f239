#include "common/catenary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "common/test/golden.h"
#include "common/testing/catenary_oracle.h"
#include "common/testing/numeric_jacobian.h"

namespace tautline {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTetherWeight = 0.0061 * 9.81;

TEST(Catenary, AgreesWithTheReference) {
  for (const golden::Forward& c : golden::loadForward()) {
    CatenaryJacobian J;
    const CatenarySolution got = solveCatenary({c.L, c.theta_D, c.T_D, c.w}, &J);
    ASSERT_TRUE(got.ok);
    const double tolerance = 1e-12 * c.L;
    EXPECT_NEAR(got.r, c.r, tolerance);
    EXPECT_NEAR(got.h, c.h, tolerance);
    EXPECT_NEAR(got.chord, c.chord, tolerance);
    EXPECT_NEAR(got.H, c.H, 1e-12 * c.T_D);
    EXPECT_NEAR(got.V_D, c.V_D, 1e-12 * c.T_D);
    EXPECT_NEAR(got.V_A, c.V_A, 1e-12 * c.T_D);
    EXPECT_NEAR(got.T_A, c.T_A, 1e-12 * c.T_D);
    EXPECT_NEAR(got.theta_A, c.theta_A, 1e-11);
    EXPECT_NEAR(got.chord_elevation, c.chord_elevation, 1e-11);
    EXPECT_EQ(got.dips_below_anchor, c.V_A < 0.0);
    for (int i = 0; c.J && i < 2; ++i) {
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(J(i, j), (*c.J)(i, j), 1e-10 * std::fmax(1.0, std::abs((*c.J)(i, j))))
            << "J(" << i << "," << j << ") L " << c.L << " theta " << c.theta_D << " T " << c.T_D;
      }
    }
  }
}

// L [m], theta_D [deg], T_D [N], w [N/m]: hanging slack to nearly taut.
class CatenarySweep : public ::testing::TestWithParam<std::tuple<double, double, double, double>> {
 protected:
  CatenaryInput in() const {
    const auto [L, theta_deg, T_D, w] = GetParam();
    return {L, theta_deg * kPi / 180.0, T_D, w};
  }
};

TEST_P(CatenarySweep, MatchesTheForceBalanceAlongTheTether) {
  const CatenarySolution got = solveCatenary(in());
  ASSERT_TRUE(got.ok);
  const testing::TetherEnd want = testing::integrateTether(in().L, in().theta_D, in().T_D, in().w);
  EXPECT_NEAR(got.r, want.r, 1e-13 * in().L);
  EXPECT_NEAR(got.h, want.h, 1e-13 * in().L);
  EXPECT_LE(got.chord, in().L * (1.0 + 1e-15));
  EXPECT_LE(got.chord_elevation, in().theta_D + 1e-12);
  EXPECT_GE(got.chord_elevation, got.theta_A - 1e-12);
}

TEST_P(CatenarySweep, JacobianIsTheDerivative) {
  CatenaryInput base = in();
  base.theta_D = std::clamp(base.theta_D, -kPi / 2 + 1e-3, kPi / 2 - 1e-3);  // room for the step
  CatenaryJacobian J;
  const CatenarySolution got = solveCatenary(base, &J);
  ASSERT_TRUE(got.ok);
  // The step must stay small against the length over which a nearly vertical slack tether turns
  // round.
  if (got.T_A < 1e-2 * base.T_D)
    GTEST_SKIP() << "tether nearly weightless at A: differences too coarse";
  const auto f = [&](const Eigen::Vector3d& x) {
    const CatenarySolution s = solveCatenary({x(0), x(1), x(2), base.w});
    return Eigen::Vector2d(s.r, s.h);
  };
  const double step = 1e-5 * std::min({1.0, base.L, base.T_D});
  const CatenaryJacobian numeric =
      testing::numericJacobian<2, 3>(f, Eigen::Vector3d(base.L, base.theta_D, base.T_D), step);
  // Rounding of the differences is about 1e-16 L / step.
  const double scale = std::fmax(1.0, numeric.cwiseAbs().maxCoeff());
  EXPECT_LT((J - numeric).cwiseAbs().maxCoeff(), 1e-6 * scale) << J << "\n\n" << numeric;
}

INSTANTIATE_TEST_SUITE_P(Grid, CatenarySweep,
                         ::testing::Combine(::testing::Values(0.02, 1.0, 4.0, 25.0),
                                            ::testing::Values(-90.0, -60.0, -5.0, 0.0, 15.0, 45.0,
                                                              75.0, 89.9, 90.0),
                                            ::testing::Values(0.05, 0.3, 1.0, 10.0),
                                            ::testing::Values(1e-9, 1e-3, kTetherWeight, 0.5)));

TEST(Catenary, RandomSegmentsOverTheWholeDomain) {
  std::mt19937 random(11);
  const auto log_uniform = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  double worst = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double off_vertical = log_uniform(1e-6, kPi / 2);
    const double theta = (i % 3 == 0 ? -1.0 : 1.0) * (kPi / 2 - off_vertical);
    const CatenaryInput in{log_uniform(1e-3, 1e2), theta, log_uniform(1e-3, 1e2),
                           log_uniform(1e-9, 1.0)};
    const CatenarySolution got = solveCatenary(in);
    ASSERT_TRUE(got.ok);
    const testing::TetherEnd want = testing::integrateTether(in.L, in.theta_D, in.T_D, in.w);
    worst = std::max({worst, std::abs(got.r - want.r) / in.L, std::abs(got.h - want.h) / in.L});
    ASSERT_LT(worst, 1e-13) << "L " << in.L << " theta " << in.theta_D << " T " << in.T_D << " w "
                            << in.w;
  }
  RecordProperty("worst_error_over_L", std::to_string(worst));
}

TEST(Catenary, AgreesWithTheSquareRootForm) {
  // The chord of a catenary also obeys L^2 - h^2 = (2a sinh(r/2a))^2, a = H/w: another algebra for
  // the same curve.
  for (double theta = -1.2; theta < 1.3; theta += 0.2) {
    const CatenaryInput in{3.0, theta, 0.4, kTetherWeight};
    const CatenarySolution got = solveCatenary(in);
    const double a = got.H / in.w;
    const double c = std::sqrt((in.L - got.h) * (in.L + got.h));
    EXPECT_NEAR(got.r, 2.0 * a * std::asinh(c / (2.0 * a)), 1e-12);
  }
}

TEST(Catenary, WeightlessTetherIsAStraightLine) {
  for (const double theta : {-kPi / 2, -0.7, 0.0, 0.4, kPi / 2}) {
    const CatenarySolution got = solveCatenary({3.0, theta, 2.0, 0.0});
    ASSERT_TRUE(got.ok);
    EXPECT_NEAR(got.r, 3.0 * std::cos(theta), 1e-15);
    EXPECT_NEAR(got.h, 3.0 * std::sin(theta), 1e-15);
    EXPECT_NEAR(got.theta_A, theta, 1e-15);
  }
}

TEST(Catenary, VerticalTetherCarriesItsOwnWeight) {
  const CatenarySolution above = solveCatenary({5.0, kPi / 2, 1.0, 0.05});
  EXPECT_NEAR(above.r, 0.0, 1e-14);
  EXPECT_NEAR(above.h, 5.0, 1e-14);
  EXPECT_NEAR(above.T_A, 0.75, 1e-15);
  const CatenarySolution below = solveCatenary({5.0, -kPi / 2, 1.0, 0.05});
  EXPECT_NEAR(below.h, -5.0, 1e-14);
  EXPECT_NEAR(below.T_A, 1.25, 1e-15);
}

TEST(Catenary, FirstOrderSagIsTheTextbookOne) {
  // Straight-line error w L^2 cos(theta) / (2 T), tangent minus chord elevation w L cos(theta) / (2
  // T).
  const CatenaryInput in{2.0, 0.6, 50.0, kTetherWeight};
  const CatenarySolution got = solveCatenary(in);
  const double error =
      std::hypot(got.r - in.L * std::cos(in.theta_D), got.h - in.L * std::sin(in.theta_D));
  EXPECT_NEAR(error, in.w * in.L * in.L * std::cos(in.theta_D) / (2 * in.T_D), 1e-5);
  EXPECT_NEAR(in.theta_D - got.chord_elevation, in.w * in.L * std::cos(in.theta_D) / (2 * in.T_D),
              1e-5);
}

TEST(Catenary, ZeroLengthIsThePoint) {
  CatenaryJacobian J;
  const CatenarySolution got = solveCatenary({0.0, 0.7, 1.0, 0.06}, &J);
  ASSERT_TRUE(got.ok);
  EXPECT_EQ(got.chord, 0.0);
  EXPECT_EQ(got.chord_elevation, 0.7);
  EXPECT_NEAR(J(0, 0), std::cos(0.7), 1e-15);
  EXPECT_NEAR(J(1, 0), std::sin(0.7), 1e-15);
  EXPECT_EQ(J.rightCols<2>().norm(), 0.0);
}

TEST(Catenary, RejectsInputOutsideItsDomain) {
  const CatenaryInput good{3.0, 0.4, 2.0, 0.02};
  for (const auto field :
       {&CatenaryInput::L, &CatenaryInput::theta_D, &CatenaryInput::T_D, &CatenaryInput::w}) {
    for (const double bad : {kNan, kInf, -kInf, -1.6}) {  // -1.6 rad: past vertical
      CatenaryInput in = good;
      in.*field = bad;
      EXPECT_FALSE(solveCatenary(in).ok) << bad;
    }
  }
  EXPECT_FALSE(solveCatenary({3.0, 0.4, 0.0, 0.02}).ok);
}

TEST(CatenaryInverse, AgreesWithTheReference) {
  for (const golden::Inverse& c : golden::loadInverse()) {
    const TensionEnd end = c.at_drone ? TensionEnd::kDrone : TensionEnd::kAnchor;
    const CatenaryInverse got = solveInverseCatenary(c.r, c.h, c.T, c.w, end);
    if (c.T_min) {
      EXPECT_NEAR(got.T_min, *c.T_min, 1e-12 * std::fmax(1.0, *c.T_min));
    }
    EXPECT_EQ(minimumTension(c.r, c.h, c.w, end), got.T_min);
    ASSERT_EQ(got.status, c.feasible ? CatenaryStatus::kOk : CatenaryStatus::kNotReachable);
    if (!c.feasible) continue;
    EXPECT_NEAR(got.L, c.L, 1e-11 * c.L);
    EXPECT_NEAR(got.H, c.H, 1e-10 * c.T);
    EXPECT_NEAR(got.theta_D, c.theta_D, 1e-10);
    EXPECT_NEAR(got.theta_A, c.theta_A, 1e-10);
    EXPECT_NEAR(got.T_D, c.T_D, 1e-12 * c.T_D);
    EXPECT_NEAR(got.T_A, c.T_A, 1e-12 * c.T_D);
  }
}

// r [m], h [m], T over T_min, w [N/m].
class CatenaryInverseSweep
    : public ::testing::TestWithParam<std::tuple<double, double, double, double, TensionEnd>> {};

TEST_P(CatenaryInverseSweep, ItsTetherReachesThePoint) {
  const auto [r, h, factor, w, end] = GetParam();
  const double T_min = minimumTension(r, h, w, end);
  const double T = std::fmax(factor * T_min, 1e-6);
  const CatenaryInverse got = solveInverseCatenary(r, h, T, w, end);
  ASSERT_EQ(got.status, CatenaryStatus::kOk);
  EXPECT_DOUBLE_EQ(end == TensionEnd::kDrone ? got.T_D : got.T_A, T);
  const testing::TetherEnd reached = testing::integrateTether(got.L, got.theta_D, got.T_D, w);
  EXPECT_NEAR(reached.r, r, 1e-10 * got.L);
  EXPECT_NEAR(reached.h, h, 1e-10 * got.L);
  // Taut branch: more tension never needs more tether.
  const CatenaryInverse tighter = solveInverseCatenary(r, h, 1.01 * T, w, end);
  EXPECT_LE(tighter.L, got.L * (1.0 + 1e-14));
  EXPECT_GE(got.L, std::hypot(r, h) * (1.0 - 1e-15));
}

INSTANTIATE_TEST_SUITE_P(Grid, CatenaryInverseSweep,
                         ::testing::Combine(::testing::Values(0.0, 1e-5, 0.3, 2.5, 20.0),
                                            ::testing::Values(-4.0, -0.5, 0.0, 0.01, 1.0, 6.0),
                                            ::testing::Values(1.05, 1.5, 10.0, 1e4),
                                            ::testing::Values(1e-6, kTetherWeight, 1.0),
                                            ::testing::Values(TensionEnd::kDrone,
                                                              TensionEnd::kAnchor)));

TEST(CatenaryInverse, NoShapeCarriesLessThanTheMinimumTension) {
  // Any segment at all, wherever it happens to end, is a witness against too large a minimum; that
  // the minimum itself can be held (next test but one) is the witness against too small a one.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit;
  double closest = kInf;
  for (int i = 0; i < 3000; ++i) {
    const double T = 0.05 + 0.6 * unit(random);
    const double L = 0.1 + 12.0 * unit(random);
    const double theta = -1.5 + 3.0 * unit(random);
    const testing::TetherEnd end = testing::integrateTether(L, theta, T, kTetherWeight);
    const double T_min = minimumTension(end.r, end.h, kTetherWeight);
    ASSERT_GE(T, T_min * (1.0 - 1e-12)) << L << " " << theta << " " << T;
    closest = std::min(closest, T / T_min);
  }
  EXPECT_LT(closest, 1.001);  // and some of them come close to it
}

TEST(CatenaryInverse, PublishedFiguresOfTheReference) {
  EXPECT_NEAR(minimumTension(2.5, 2.5, kTetherWeight), 0.217, 5e-4);
  EXPECT_NEAR(minimumTension(5.0, 1.0, kTetherWeight), 0.258, 5e-4);
  EXPECT_EQ(solveInverseCatenary(2.5, 2.5, 0.21, kTetherWeight).status,
            CatenaryStatus::kNotReachable);
  EXPECT_EQ(solveInverseCatenary(2.5, 2.5, 0.22, kTetherWeight).status, CatenaryStatus::kOk);
}

TEST(CatenaryInverse, MinimumTensionItselfIsReachable) {
  const double T_min = minimumTension(2.0, 1.0, kTetherWeight);
  const CatenaryInverse got = solveInverseCatenary(2.0, 1.0, T_min, kTetherWeight);
  ASSERT_EQ(got.status, CatenaryStatus::kOk);
  const testing::TetherEnd reached =
      testing::integrateTether(got.L, got.theta_D, T_min, kTetherWeight);
  EXPECT_NEAR(reached.r, 2.0, 1e-6);  // a double root: half the digits
  EXPECT_NEAR(reached.h, 1.0, 1e-6);
}

TEST(CatenaryInverse, LimitsAndDomain) {
  const CatenaryInverse point = solveInverseCatenary(0, 0, 1.0, kTetherWeight);
  ASSERT_TRUE(point);
  EXPECT_EQ(point.L, 0.0);
  EXPECT_EQ(point.theta_D, 0.0);
  const CatenaryInverse straight = solveInverseCatenary(3.0, 4.0, 1.0, 0.0);
  EXPECT_DOUBLE_EQ(straight.L, 5.0);
  EXPECT_DOUBLE_EQ(straight.theta_D, std::atan2(4.0, 3.0));
  const CatenaryInverse hanging = solveInverseCatenary(0.0, -3.0, 1.0, kTetherWeight);
  EXPECT_DOUBLE_EQ(hanging.theta_D, -kPi / 2);
  EXPECT_NEAR(hanging.T_A, 1.0 + 3.0 * kTetherWeight, 1e-15);
  EXPECT_EQ(solveInverseCatenary(0.0, 3.0, 2.9 * kTetherWeight, kTetherWeight).status,
            CatenaryStatus::kNotReachable);
  EXPECT_TRUE(solveInverseCatenary(1e-200, 1.0, 1.0, kTetherWeight));
  EXPECT_TRUE(solveInverseCatenary(1.0, 1e-200, 1.0, kTetherWeight));
  for (const double bad : {kNan, kInf, -1.0}) {
    EXPECT_EQ(solveInverseCatenary(bad, 1, 1, 0.06).status, CatenaryStatus::kInvalid);
    EXPECT_EQ(solveInverseCatenary(1, 1, bad, 0.06).status, CatenaryStatus::kInvalid);
    EXPECT_EQ(solveInverseCatenary(1, 1, 1, bad).status, CatenaryStatus::kInvalid);
    EXPECT_EQ(minimumTension(bad, 1, 0.06), 0.0);
  }
  EXPECT_EQ(solveInverseCatenary(1, kNan, 1, 0.06).status, CatenaryStatus::kInvalid);
}

TEST(TensionFromReel, AgreesWithTheReference) {
  for (const golden::Reel& c : golden::loadReel()) {
    const ReelTension got = tensionFromReel(c.T_A, c.L, c.theta_D, c.w);
    ASSERT_EQ(got.ok, c.feasible);
    if (!c.feasible) continue;
    EXPECT_NEAR(got.T_D, c.T_D, 1e-12 * c.T_D);
    const CatenarySolution segment = solveCatenary({c.L, c.theta_D, got.T_D, c.w});
    EXPECT_NEAR(segment.r, c.r, 1e-11 * c.L);
    EXPECT_NEAR(segment.h, c.h, 1e-11 * c.L);
    EXPECT_NEAR(segment.T_A, c.T_A, 1e-12 * c.T_A);
  }
}

TEST(TensionFromReel, ContactsScaleTheTensionAtTheAnchor) {
  const double factor = std::exp(0.3 * kPi / 2);  // mu = 0.3 over a right angle
  EXPECT_NEAR(factor, 1.6, 0.01);
  const ReelTension got = tensionFromReel(0.5, 2.0, 0.6, kTetherWeight, factor);
  ASSERT_TRUE(got.ok);
  EXPECT_NEAR(solveCatenary({2.0, 0.6, got.T_D, kTetherWeight}).T_A, 0.5 * factor, 1e-14);
  EXPECT_FALSE(tensionFromReel(0.5, 20.0, 0.0, kTetherWeight).ok);  // cannot carry 1.2 N of tether
  EXPECT_FALSE(tensionFromReel(kNan, 2.0, 0.6, kTetherWeight).ok);
  EXPECT_FALSE(tensionFromReel(0.5, 2.0, 0.6, kTetherWeight, 0.0).ok);
}

}  // namespace
}  // namespace tautline
