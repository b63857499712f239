#include "common/tether_geometry.h"

#include <cmath>
#include <numbers>
#include <random>
#include <tuple>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "common/test/golden.h"
#include "common/testing/numeric_jacobian.h"

namespace tautline {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(TetherGeometry, AgreesWithTheReference) {
  for (const golden::Polar& c : golden::loadPolar()) {
    const TetherCoordinates q = toTether(c.p);
    EXPECT_NEAR(q.L, c.L, 1e-12);
    EXPECT_NEAR(q.theta, c.theta, 1e-12);
    EXPECT_NEAR(wrapAngle(q.phi - c.phi), 0.0, 1e-12);
    EXPECT_TRUE(toCartesian(q).isApprox(c.p, 1e-12)) << c.p.transpose();
    EXPECT_LT((jacobian({c.L, c.theta, c.phi}) - c.J).norm(), 1e-12);
  }
}

class TetherGeometrySweep : public ::testing::TestWithParam<std::tuple<double, double, double>> {
 protected:
  TetherCoordinates q() const {
    const auto [L, theta_deg, phi_deg] = GetParam();
    return {L, theta_deg * kPi / 180.0, phi_deg * kPi / 180.0};
  }
};

TEST_P(TetherGeometrySweep, ConvertsThereAndBack) {
  const TetherCoordinates back = toTether(toCartesian(q()));
  EXPECT_NEAR(back.L, q().L, 1e-14 * q().L);
  EXPECT_NEAR(back.theta, q().theta, 1e-14);
  EXPECT_NEAR(wrapAngle(back.phi - q().phi) * std::cos(q().theta), 0.0, 1e-14);
}

TEST_P(TetherGeometrySweep, JacobianIsTheDerivative) {
  const auto f = [](const Eigen::Vector3d& x) { return toCartesian({x(0), x(1), x(2)}); };
  const Eigen::Vector3d x(q().L, q().theta, q().phi);
  const Eigen::Matrix3d numeric = testing::numericJacobian<3, 3>(f, x);
  EXPECT_LT((jacobian(q()) - numeric).norm(), 1e-10 * std::fmax(1.0, q().L));
  EXPECT_NEAR(jacobian(q()).determinant(), -q().L * q().L * std::cos(q().theta),
              1e-12 * q().L * q().L);
}

TEST_P(TetherGeometrySweep, RatesAndVelocityAreInverse) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d v(normal(random), normal(random), normal(random));
    const Eigen::Vector3d back = velocityFromRates(q(), ratesFromVelocity(q(), v));
    EXPECT_LT((back - v).norm(), 1e-12);
    // An independent solver agrees wherever J can be inverted.
    const Eigen::Vector3d solved = jacobian(q()).inverse() * v;
    const TetherRates rates = ratesFromVelocity(q(), v);
    EXPECT_NEAR(rates.L_dot, solved(0), 1e-9);
    EXPECT_NEAR(rates.theta_dot, solved(1), 1e-9 * std::fmax(1.0, std::abs(solved(1))));
    EXPECT_NEAR(rates.phi_dot, solved(2), 1e-9 * std::fmax(1.0, std::abs(solved(2))));
  }
}

INSTANTIATE_TEST_SUITE_P(Grid, TetherGeometrySweep,
                         ::testing::Combine(::testing::Values(0.05, 1.0, 12.0),
                                            ::testing::Values(-89.0, -40.0, 0.0, 45.0, 89.0, 89.99),
                                            ::testing::Values(-179.0, -90.0, 0.0, 30.0, 135.0,
                                                              180.0)));

TEST(TetherGeometry, AxesAreTheWorlds) {
  EXPECT_TRUE(toCartesian({2.0, kPi / 2, 0.3}).isApprox(Eigen::Vector3d(0, 2, 0), 1e-15));  // up
  EXPECT_NEAR(toTether({0, 0, 3}).phi, 0.0, 0.0);        // z: phi = 0
  EXPECT_NEAR(toTether({3, 0, 0}).phi, kPi / 2, 1e-15);  // x: a quarter turn about +y
  EXPECT_EQ(toTether({-0.0, 0, -1}).phi, kPi);           // never -pi
}

TEST(TetherGeometry, SingularSetIsFiniteAndDocumented) {
  const TetherCoordinates at_anchor = toTether(Eigen::Vector3d::Zero());
  EXPECT_EQ(at_anchor.L, 0.0);
  EXPECT_EQ(at_anchor.theta, 0.0);
  EXPECT_EQ(at_anchor.phi, 0.0);
  EXPECT_EQ(toTether({0, -2, 0}).phi, 0.0);
  EXPECT_DOUBLE_EQ(toTether({0, -2, 0}).theta, -kPi / 2);

  const TetherRates at_zero_length = ratesFromVelocity({0.0, 0.4, 0.1}, {1, 1, 1});
  EXPECT_EQ(at_zero_length.theta_dot, 0.0);
  EXPECT_EQ(at_zero_length.phi_dot, 0.0);
  EXPECT_NEAR(at_zero_length.L_dot, toCartesian({1.0, 0.4, 0.1}).dot(Eigen::Vector3d::Ones()),
              1e-15);

  // On the axis, phi chooses the plane; a velocity in it still maps to theta, one across it is
  // dropped.
  const TetherCoordinates pole{2.0, kPi / 2, 0.0};
  const TetherRates rates = ratesFromVelocity(pole, {0.5, 0.2, 0.4});
  EXPECT_NEAR(rates.L_dot, 0.2, 1e-12);
  EXPECT_NEAR(rates.theta_dot, -0.2, 1e-12);
  EXPECT_EQ(rates.phi_dot, 0.0);
}

TEST(TetherGeometry, WrapsToTheHalfOpenInterval) {
  EXPECT_EQ(wrapAngle(kPi), kPi);
  EXPECT_EQ(wrapAngle(-kPi), kPi);
  EXPECT_EQ(wrapAngle(0.1), 0.1);
  for (int turn = -3; turn <= 3; ++turn) {
    for (double angle = -3.1; angle < 3.2; angle += 0.31) {
      EXPECT_NEAR(wrapAngle(angle + 2 * kPi * turn), angle, 1e-14);
    }
  }
}

}  // namespace
}  // namespace tautline
