#include "sim_hil/tether_chain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

namespace tautline::sim {
namespace {

constexpr double kG = 9.81;
constexpr double kPi = std::numbers::pi;
constexpr double kStep = 0.002;
const Eigen::Vector3d kStill = Eigen::Vector3d::Zero();
const Eigen::Vector3d kDown(0.0, -1.0, 0.0);

/// For docs/simulator.md: sim_hil_test --gtest_output=json:figures.json
void record(const std::string& name, double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  ::testing::Test::RecordProperty(name, text.data());
}

Obstacles nothing() {
  Scene scene;
  scene.floor = -100.0;
  return Obstacles(scene);
}

/// Oracle: walk from the drone down the tether with the force balance of each small piece (midpoint
/// rule). Shares nothing with the chain.
struct Catenary {
  double reach{0.0};
  double height{0.0};
  double tension_at_reel{0.0};
};
Catenary marchFromDrone(double T, double theta, double L, double w, double EA, int pieces = 20000) {
  const double ds = L / pieces;
  const double H = T * std::cos(theta);
  Catenary c;
  for (int i = 0; i < pieces; ++i) {
    const double V = T * std::sin(theta) - w * (i + 0.5) * ds;
    const double stretched = ds * (1.0 + std::hypot(H, V) / EA);
    c.reach += stretched * H / std::hypot(H, V);
    c.height += stretched * V / std::hypot(H, V);
  }
  c.tension_at_reel = std::hypot(H, T * std::sin(theta) - w * L);
  return c;
}

/// Lets a chain whose end is pulled by a constant force come to rest.
TetherChain hangAt(TetherConfig config, double T, double theta, double L) {
  config.internal_damping = 0.03;
  const Eigen::Vector3d direction(0.0, std::sin(theta), std::cos(theta));
  TetherChain chain(config, L * direction, L);
  const Obstacles obstacles = nothing();
  EndLoad end;
  end.mass = 0.05;
  end.force = T * direction;
  end.drag = 0.1;
  for (int i = 0; i < 6000; ++i) chain.step(0.005, L, end, kStill, obstacles);
  return chain;
}

class StaticShape : public ::testing::TestWithParam<std::tuple<double, double, double>> {};

TEST_P(StaticShape, ConvergesToTheCatenary) {
  const auto [T, theta_deg, L] = GetParam();
  const double theta = theta_deg * kPi / 180.0;
  TetherConfig config;
  const Catenary want = marchFromDrone(T, theta, L, config.density * kG, config.axial_stiffness);
  std::vector<double> error;
  for (const int links : {12, 24, 48}) {
    config.links = links;
    const TetherChain chain = hangAt(config, T, theta, L);
    const Eigen::Vector3d p = chain.position(links);
    EXPECT_NEAR(p.x(), 0.0, 1e-9);
    error.push_back(std::hypot(p.z() - want.reach, p.y() - want.height));
    EXPECT_LT(chain.velocity(links).norm(), 1e-3) << links;
    EXPECT_NEAR(chain.reelTension(), want.tension_at_reel, 0.01 * T) << links;
    EXPECT_NEAR(chain.endTension().norm(), T, 1e-3 * T) << links;
    EXPECT_NEAR(std::asin(chain.endTension().normalized().y()), theta, 2e-3) << links;
  }
  record("error_12_links_m", error[0]);
  record("error_24_links_m", error[1]);
  record("error_48_links_m", error[2]);
  EXPECT_LT(error[1], 1e-3 * L) << "24 links";
  EXPECT_LT(error[2], 0.35 * error[0] + 1e-4) << "second order in the number of links";
}
INSTANTIATE_TEST_SUITE_P(Grid, StaticShape,
                         ::testing::Combine(::testing::Values(0.3, 1.0, 3.0),
                                            ::testing::Values(20.0, 50.0, 80.0),
                                            ::testing::Values(0.5, 3.0)));

TEST(TetherChain, SlackTetherHangsAsACatenaryBetweenItsEnds) {
  TetherConfig config;
  config.links = 40;
  config.internal_damping = 0.05;
  const double span = 1.0;
  const double L = 1.5;
  TetherChain chain(config, {0.0, 0.0, span}, L);
  EndLoad fixed;
  fixed.mass = 1e9;
  const Obstacles obstacles = nothing();
  for (int i = 0; i < 8000; ++i) chain.step(kStep, L, fixed, kStill, obstacles);
  // Oracle: bisection on the horizontal tension for which the reach of a symmetric half is right.
  const double w = config.density * kG;
  double lo = 1e-6;
  double hi = 10.0;
  for (int i = 0; i < 100; ++i) {
    const double H = 0.5 * (lo + hi);
    const double T = std::hypot(H, 0.5 * w * L);
    const Catenary half = marchFromDrone(T, std::asin(0.5 * w * L / T), 0.5 * L, w, 1e4, 2000);
    (half.reach < 0.5 * span ? lo : hi) = H;
  }
  const double T = std::hypot(lo, 0.5 * w * L);
  const double sag = marchFromDrone(T, std::asin(0.5 * w * L / T), 0.5 * L, w, 1e4, 2000).height;
  EXPECT_NEAR(chain.position(20).y(), -sag, 0.005);
  EXPECT_NEAR(chain.reelTension(), T, 0.02 * T);
}

TEST(TetherChain, SlackLinksDoNotPush) {
  TetherConfig config;
  TetherChain chain(config, {0.0, 0.0, 1.0}, 1.5);
  EndLoad fixed;
  fixed.mass = 1e9;
  chain.step(kStep, 1.5, fixed, kStill, nothing());
  for (int j = 0; j < chain.linkCount(); ++j) EXPECT_EQ(chain.linkTension(j), 0.0);
}

TEST(TetherChain, EnergyNeverGrowsWithoutInput) {
  for (const double h : {0.002, 0.005}) {
    for (const double mass : {0.05, 0.618}) {
      TetherConfig config;
      config.drag_coefficient = 0.0;
      config.internal_damping = 0.0;
      TetherChain chain(config, {0.3, 1.5, 1.2}, 2.2);  // slack at first, then a hard jerk
      EndLoad end;
      end.mass = mass;
      end.force = mass * kG * kDown;
      const Obstacles obstacles = nothing();
      double before = chain.energy(mass);
      const double start = before;
      double growth = -1.0;
      for (int i = 0; i < 5000; ++i) {
        chain.step(h, 2.2, end, kStill, obstacles);
        const double now = chain.energy(mass);
        ASSERT_LE(now, before + 2e-6) << "step " << i << ", h " << h << ", mass " << mass;
        growth = std::fmax(growth, now - before);
        before = now;
      }
      record("largest_growth_in_a_step_J", growth);
      EXPECT_LT(before, start);
      EXPECT_GT(before, -mass * kG * 2.3);
    }
  }
}

TEST(TetherChain, PendulumPeriod) {
  TetherConfig config;
  config.drag_coefficient = 0.0;
  config.internal_damping = 0.0;
  const double L = 2.0;
  const double m = 0.618;
  const double amplitude = 0.05;
  TetherChain chain(config, {0.0, -L * std::cos(amplitude), L * std::sin(amplitude)}, L);
  EndLoad end;
  end.mass = m;
  end.force = m * kG * kDown;
  const Obstacles obstacles = nothing();
  std::vector<double> crossings;
  double last = 1.0;
  for (int i = 1; i < 10000; ++i) {
    chain.step(kStep, L, end, kStill, obstacles);
    const double z = chain.position(24).z();
    if (last > 0.0 && z <= 0.0) crossings.push_back(kStep * (i - z / (z - last)));
    last = z;
  }
  ASSERT_GE(crossings.size(), 5U);
  const double period =
      (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  // Compound pendulum: point mass and thin rod.
  const double rod = config.density * L;
  const double want = 2.0 * kPi * std::sqrt(L * (m + rod / 3.0) / (kG * (m + rod / 2.0))) *
                      (1.0 + amplitude * amplitude / 16.0);
  record("period_error_percent", 100.0 * (period / want - 1.0));
  EXPECT_NEAR(period, want, 0.003 * want);
}

TEST(TetherChain, StableAtHighTensionAndLongSteps) {
  TetherConfig config;
  config.links = 48;
  for (const double L : {0.3, 2.0, 10.0}) {
    TetherChain chain(config, {0.0, 0.0, L}, L);
    EndLoad end;
    end.force = {0.3, 1.0, 12.0};
    const Obstacles obstacles = nothing();
    for (int i = 0; i < 2000; ++i) chain.step(0.005, L, end, {3.0, 0.0, 0.0}, obstacles);
    const double strain = chain.position(48).norm() / L - 1.0;
    EXPECT_GT(strain, 0.0);
    EXPECT_LT(strain, 0.01) << "nearly inextensible";
  }
}

// --- contact ------------------------------------------------------------------------------------

/// Drives the end to a point like a strong autopilot.
EndLoad pullTo(const TetherChain& chain, const Eigen::Vector3d& target) {
  const int n = chain.linkCount();
  EndLoad end;
  end.force = 200.0 * (target - chain.position(n)) - 20.0 * chain.velocity(n);
  return end;
}

Scene pillar() {
  Scene scene;
  scene.floor = -1.0;
  scene.boxes.push_back({"pillar", {0.5, -1.0, 1.0}, {0.9, 3.0, 1.4}});
  return scene;
}

/// Horizontal length of the way round the corner at (0.5, 1.4), given that it bends there.
double lengthRoundCorner(const Eigen::Vector3d& p) {
  const Eigen::Vector2d corner(0.5, 1.4);
  const double flat = corner.norm() + (Eigen::Vector2d(p.x(), p.z()) - corner).norm();
  return std::hypot(flat, p.y());
}

class Wrap : public ::testing::TestWithParam<double> {};

TEST_P(Wrap, RoundAnEdgeAndOffAgain) {
  const Obstacles obstacles(pillar());
  TetherConfig config;
  config.friction = GetParam();
  config.density = 1e-3;  // little sag: the oracle is a taut string
  const Eigen::Vector3d a(0.0, 0.6, 2.0);
  const Eigen::Vector3d b(1.6, 0.6, 1.8);
  TetherChain chain(config, a, a.norm());
  double t = 0.0;
  const auto fly = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to, double seconds) {
    for (double s = 0.0; s < seconds; s += kStep, t += kStep) {
      const double part = std::fmin(1.0, s / (0.7 * seconds));
      const Eigen::Vector3d target = from + part * (to - from);
      const double bent = std::atan2(target.x(), target.z()) > std::atan2(0.5, 1.4);
      const double taut = bent != 0.0 ? lengthRoundCorner(target) : target.norm();
      chain.step(kStep, taut - 0.005, pullTo(chain, target), kStill, obstacles);
      for (int i = 0; i <= chain.linkCount(); ++i) {
        ASSERT_GT(obstacles.clearance(chain.position(i), false), -0.005) << "t " << t;
      }
    }
  };
  fly(a, b, 6.0);
  ASSERT_EQ(chain.bends().size(), 1U);
  for (const EdgeContact& c : chain.bends()) {
    const Eigen::Vector3d p = c.point();
    EXPECT_NEAR(p.x(), 0.5, 0.01);
    EXPECT_NEAR(p.z(), 1.4, 0.01);
    // Without friction the tether takes the shortest way; with it, it may stay where it first
    // touched.
    const double share = std::hypot(0.5, 1.4) / (std::hypot(0.5, 1.4) + std::hypot(1.1, 0.4));
    if (config.friction == 0.0) {
      EXPECT_NEAR(p.y(), 0.6 * share, 0.03);
    }
    EXPECT_GT(p.y(), 0.1);
    EXPECT_LT(p.y(), 0.6 * share + 0.03);
  }
  // The tether's bend is at the edge: the length agrees with that of the taut string.
  record("length_error_m", chain.length() - lengthRoundCorner(chain.position(24)));
  EXPECT_NEAR(chain.length(), lengthRoundCorner(chain.position(24)), 0.015);
  fly(b, a, 6.0);
  EXPECT_TRUE(chain.bends().empty());
  EXPECT_NEAR(chain.position(24).norm(), chain.length(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Friction, Wrap, ::testing::Values(0.0, 0.3));

/// Column with 16 sides and the tether bent round a part of it, sliding.
double slidingTensionRatio(double friction, double wrap) {
  Scene scene;
  scene.floor = -100.0;
  Prism column;
  column.name = "column";
  column.y_min = -1.0;
  column.y_max = 1.0;
  const double radius = 0.2;
  const Eigen::Vector2d centre(1.0, -radius);  // (z, x): the first part runs along z, touching
  for (int i = 0; i < 16; ++i) {
    const double a = 2.0 * kPi * (i + 0.5) / 16.0;
    column.footprint.emplace_back(centre.x() + radius * std::cos(a),
                                  centre.y() + radius * std::sin(a));
  }
  scene.prisms.push_back(column);
  const Obstacles obstacles(scene);
  TetherConfig config;
  config.links = 48;
  config.density = 2e-4;
  config.friction = friction;
  // Starts in a straight line past the column, then the end is pulled round it by `wrap`.
  TetherChain chain(config, {0.0, 0.0, 2.5}, 2.5);
  EndLoad end;
  double L = 2.5;
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < 7000; ++i) {
    const double turned = wrap * std::fmin(1.0, i / 3000.0);
    end.force = 2.0 * Eigen::Vector3d(-std::sin(turned), 0.0, std::cos(turned));
    end.mass = 0.05;
    end.drag = 1.0;
    if (i > 4000) L -= 0.1 * kStep;
    chain.step(kStep, L, end, kStill, obstacles);
    if (i > 6000) {
      sum += chain.reelTension() / chain.endTension().norm();
      ++count;
    }
  }
  return sum / count;
}

TEST(TetherContact, CapstanLaw) {
  EXPECT_NEAR(slidingTensionRatio(0.0, kPi / 2.0), 1.0, 0.02);
  for (const double wrap : {kPi / 4.0, kPi / 2.0}) {
    const double want = std::exp(0.3 * wrap);
    const double ratio = slidingTensionRatio(0.3, wrap);
    record("ratio_over_law_at_" + std::to_string(std::lround(wrap * 180.0 / kPi)) + "_deg",
           ratio / want);
    EXPECT_NEAR(ratio, want, 0.03 * want) << wrap;
  }
}

TEST(TetherContact, LiesOnTheFloor) {
  Scene scene;
  scene.floor = -0.3;
  const Obstacles obstacles(scene);
  TetherConfig config;
  TetherChain chain(config, {0.0, -0.3, 1.0}, 1.6);
  EndLoad end;
  end.force = end.mass * kG * kDown;
  end.ground = -0.2;
  for (int i = 0; i < 5000; ++i) chain.step(kStep, 1.6, end, kStill, obstacles);
  EXPECT_NEAR(chain.position(24).y(), -0.2, 0.002);
  int lying = 0;
  for (int i = 1; i < 24; ++i) {
    EXPECT_GT(chain.position(i).y(), -0.302);
    if (chain.position(i).y() < -0.298) ++lying;
  }
  EXPECT_GT(lying, 8);
  EXPECT_NEAR(chain.groundForce(), 0.618 * kG, 0.1);
  EXPECT_LT(chain.velocity(12).norm(), 0.01);
}

}  // namespace
}  // namespace tautline::sim
