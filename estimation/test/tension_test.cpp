#include "estimation/tension.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "common/testing/numeric_jacobian.h"
#include "estimation/test/golden.h"

namespace tautline {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kG = 6.0;

using Vector1d = Eigen::Matrix<double, 1, 1>;

TEST(LeanTension, AgreesWithTheReference) {
  for (const golden::Lean& c : golden::loadLean()) {
    EXPECT_NEAR(leanModel(c.T, c.theta, c.G).beta, c.beta, 1e-13);
    const LeanForces got = forcesFromLean(c.beta, c.theta, c.G);
    ASSERT_TRUE(got.ok);
    // One rounding of beta is worth this much tension: eq. (4) itself loses the rest.
    const double loss = std::abs(c.dlnT_dbeta) * 1e-15;
    EXPECT_NEAR(got.T, c.T, (1e-12 + loss) * c.T);
    EXPECT_NEAR(got.F, c.F, (1e-12 + loss) * c.F);
    EXPECT_NEAR(relativeTensionSensitivity(c.T, c.theta, c.G), c.dlnT_dbeta,
                1e-11 * std::abs(c.dlnT_dbeta));
  }
}

TEST(LeanTension, ForcesBalance) {
  for (double theta = -1.2; theta < 1.5; theta += 0.1) {
    for (const double beta : {theta + 0.05, 0.5 * (theta + kPi / 2), kPi / 2 - 1e-3}) {
      const LeanForces f = forcesFromLean(beta, theta, kG);
      if (!f.ok) continue;
      EXPECT_NEAR(f.F * std::cos(beta), f.T * std::cos(theta), 1e-10 * f.F);
      EXPECT_NEAR(f.F * std::sin(beta), f.T * std::sin(theta) + kG, 1e-10 * f.F);
    }
  }
}

TEST(LeanTension, RefusesLeansThatNoTensionExplains) {
  EXPECT_FALSE(forcesFromLean(0.5, 0.6, kG).ok);            // thrust below the tether's line
  EXPECT_FALSE(forcesFromLean(kPi / 2 + 0.1, 0.6, kG).ok);  // leaning towards the anchor
  EXPECT_FALSE(forcesFromLean(kNan, 0.6, kG).ok);
  EXPECT_FALSE(forcesFromLean(1.2, kNan, kG).ok);
}

TEST(LeanTension, SensitivityIsTheDerivativeOfTheLogarithm) {
  for (const double theta : {-0.5, 0.2, kPi / 4, 75 * kDegree}) {
    for (const double T : {0.2, 0.5, 2.0}) {
      const auto log_T = [&](const Vector1d& beta) {
        return Vector1d(std::log(forcesFromLean(beta(0), theta, kG).T));
      };
      const double beta = leanModel(T, theta, kG).beta;
      const double numeric = testing::numericJacobian<1, 1>(log_T, Vector1d(beta), 1e-5)(0);
      EXPECT_NEAR(relativeTensionSensitivity(T, theta, kG), numeric, 1e-4 * std::abs(numeric));
    }
  }
  // Figures of docs/tether_model.md, section 2: percent of tension per degree of lean.
  EXPECT_NEAR(-relativeTensionSensitivity(0.5, 45 * kDegree, kG) * kDegree, 0.33, 0.01);
  EXPECT_NEAR(-relativeTensionSensitivity(0.5, 85 * kDegree, kG) * kDegree, 2.82, 0.02);
}

TEST(LeanModel, SlopesAreDerivatives) {
  for (double theta = -1.4; theta < 1.5; theta += 0.2) {
    for (const double T : {0.05, 0.5, 6.0}) {
      const auto beta = [&](const Eigen::Vector2d& x) {
        return Vector1d(leanModel(x(0), x(1), kG).beta);
      };
      const Eigen::Matrix<double, 1, 2> numeric =
          testing::numericJacobian<1, 2>(beta, Eigen::Vector2d(T, theta));
      EXPECT_NEAR(leanModel(T, theta, kG).dbeta_dT, numeric(0), 1e-9);
      EXPECT_NEAR(leanModel(T, theta, kG).dbeta_dtheta, numeric(1), 1e-9);
    }
  }
}

TEST(ThrustElevation, AgreesWithTheReference) {
  for (const golden::Attitude& c : golden::loadAttitude()) {
    EXPECT_NEAR(thrustElevation(c.R_WB), c.beta, 1e-12);
    const double phi = std::atan2(c.n.x(), c.n.z());
    EXPECT_NEAR(thrustElevationInPlane(c.R_WB, phi), c.beta, 1e-12);
    Eigen::Quaterniond scaled = c.R_WB;
    scaled.coeffs() *= 3.0;
    EXPECT_NEAR(thrustElevation(scaled), c.beta, 1e-12);
  }
}

TEST(ThrustElevation, IsSignedInThePlaneOfTheTether) {
  // Turning about -x tips the thrust axis towards +z: outwards for a drone at phi = 0.
  const double lean = 0.1;
  const Eigen::Quaterniond outwards(Eigen::AngleAxisd(lean, Eigen::Vector3d::UnitX()));
  EXPECT_NEAR(thrustElevation(outwards), kPi / 2 - lean, 1e-15);
  EXPECT_NEAR(thrustElevationInPlane(outwards, 0.0), kPi / 2 - lean, 1e-15);
  EXPECT_NEAR(thrustElevationInPlane(outwards, kPi), kPi / 2 + lean, 1e-15);
  EXPECT_NEAR(thrustElevationInPlane(outwards, kPi / 2), kPi / 2, 1e-15);
}

TEST(ThrustElevation, OfNoAttitudeIsLevel) {
  EXPECT_DOUBLE_EQ(thrustElevation(Eigen::Quaterniond(0, 0, 0, 0)), kPi / 2);
  EXPECT_DOUBLE_EQ(thrustElevation(Eigen::Quaterniond(kNan, 0, 0, 0)), kPi / 2);
}

TEST(MapTension, AgreesWithTheReference) {
  for (const golden::Map& c : golden::loadMap()) {
    const TensionEstimate got =
        mapTension(c.beta, c.sigma_beta, c.theta, c.G, {c.T_prior, c.sigma_T});
    EXPECT_NEAR(got.T, c.T_map, 1e-9 * std::fmax(1.0, c.T_map));
    EXPECT_NEAR(got.sigma, c.sigma_map, 1e-6 * c.sigma_map);
  }
}

TEST(MapTension, IsTheLeastCostOnAFineGrid) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit;
  for (int i = 0; i < 60; ++i) {
    const double theta = -0.5 + 2.0 * unit(random);
    const double sigma_beta = (0.5 + 2.0 * unit(random)) * kDegree;
    const double beta = leanModel(0.1 + 2.0 * unit(random), theta, kG).beta +
                        2.0 * sigma_beta * (unit(random) - 0.5);
    const TensionPrior prior{0.2 + 2.0 * unit(random), 0.05 + 0.5 * unit(random)};
    const auto cost = [&](double T) {
      return std::pow(
                 (beta - std::atan2(kG + T * std::sin(theta), T * std::cos(theta))) / sigma_beta,
                 2) +
             std::pow((T - prior.T) / prior.sigma, 2);
    };
    const double T_lower = i % 2 == 0 ? 0.0 : 0.4;
    double best = T_lower;
    for (double T = T_lower; T < 5.0; T += 1e-4) {
      if (cost(T) < cost(best)) best = T;
    }
    EXPECT_NEAR(mapTension(beta, sigma_beta, theta, kG, prior, T_lower).T, best, 2e-4);
  }
}

TEST(MapTension, DegeneratesToThePriorWhereTheLeanSaysNothing) {
  const TensionPrior prior{0.7, 0.1};
  for (const double beta : {1.0, kPi / 2, 1.7}) {
    const TensionEstimate got = mapTension(beta, 1.0 * kDegree, kPi / 2, kG, prior);
    EXPECT_NEAR(got.T, prior.T, 1e-9);
    EXPECT_NEAR(got.sigma, prior.sigma, 1e-9);
  }
  EXPECT_EQ(mapTension(kNan, 0.02, 0.5, kG, prior).T, prior.T);
  EXPECT_EQ(mapTension(1.2, 0.02, kNan, kG, prior).T, prior.T);
}

TEST(MapTension, NeverGoesBelowItsLowerBound) {
  EXPECT_EQ(mapTension(kPi / 2 + 0.2, 0.01, 0.5, kG, {0.3, 0.5}, 0.25).T, 0.25);
  EXPECT_EQ(mapTension(kNan, 0.01, 0.5, kG, {0.1, 0.5}, 0.25).T, 0.25);
}

}  // namespace
}  // namespace tautline
