// What the pull on the tether and its sensors tell, with signals made up for each case.

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "supervision/detect/contact_watch.h"
#include "supervision/detect/oscillation_watch.h"
#include "supervision/detect/tether_watch.h"

namespace tautline {
namespace {

using C = Condition;
constexpr double kPi = std::numbers::pi;
constexpr Duration kCycle = std::chrono::milliseconds(10);
constexpr double kDt = 0.01;

/// A drone that hangs well on its tether, and a watch on it.
struct Tether {
  TetherWatchConfig config;
  TetherWatch watch{config};
  TetherWatchInput in{.flying = true,
                      .L_total = 2.0,
                      .L_max = 10.0,
                      .L_free = 2.0,
                      .theta = 0.8,
                      .lean_angle = 0.7,
                      .T_lean = 1.0};
  Time now{};
  Findings findings;

  /// Runs `seconds`, moving along with what is commanded by `follow`; true if `c` was raised.
  bool run(double seconds, C c, double follow = 1.0) {
    bool raised = false;
    for (const Time end = now + fromSeconds(seconds); now < end; now += kCycle) {
      in.L_total += follow * in.length_rate * kDt;
      in.L_free += follow * in.length_rate * kDt;
      in.theta += follow * in.elevation_rate * kDt;
      findings = {};
      watch.update(now, in, findings);
      raised = raised || findings.raised.has(c);
    }
    return raised;
  }
};

TEST(TetherWatch, WellHungTetherRaisesNothing) {
  Tether t;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.15);
  for (int i = 0; i < 3000; ++i) {
    t.in.T_lean = std::max(0.2, 1.0 + noise(random));
    t.in.length_rate = 0.3 * std::sin(0.005 * i);
    t.run(0.01, C::kTetherSlack);
    EXPECT_TRUE(t.findings.raised.empty()) << describe(t.findings.raised) << " in cycle " << i;
  }
}

TEST(TetherWatch, NoPullIsSlackAndGoesWhenItPullsAgain) {
  Tether t;
  EXPECT_FALSE(t.run(6.0, C::kTetherSlack));
  t.in.T_lean = 0.03;
  EXPECT_TRUE(t.run(kDt, C::kTetherSlack));
  EXPECT_GT(t.findings.valueOf(C::kTetherSlack), t.findings.limitOf(C::kTetherSlack));
  t.in.T_lean = 0.5;
  EXPECT_FALSE(t.run(1.0, C::kTetherSlack));
}

TEST(TetherWatch, APullThatMayWellBeThereIsNoSlackTether) {
  Tether t;
  t.in.T_lean = 0.03;
  t.in.T_lean_error = 0.47;
  EXPECT_FALSE(t.run(8.0, C::kTetherSlack));
  t.in.T_lean_error = 0.0;
  EXPECT_TRUE(t.run(kDt, C::kTetherSlack));
}

TEST(TetherWatch, ALeanThatTellsNothingIsNoSlackTether) {
  Tether t;
  t.in.T_lean.reset();
  t.in.lean_angle = 0.1;
  EXPECT_FALSE(t.run(10.0, C::kTetherSlack));
  EXPECT_TRUE(t.findings.raised.has(C::kTensionUnobservable));
}

TEST(TetherWatch, TheReelsOwnSensorDecidesWhereThereIsOne) {
  Tether t;
  t.in.T_reel = 0.9;
  t.in.T_lean = 0.0;
  EXPECT_FALSE(t.run(8.0, C::kTetherSlack));
  t.in.T_reel = 0.01;
  t.in.T_lean = 1.0;
  EXPECT_TRUE(t.run(0.1, C::kTetherSlack));
}

TEST(TetherWatch, OverTensionIsOneOfEitherSensor) {
  for (const bool reel : {false, true}) {
    Tether t;
    EXPECT_FALSE(t.run(6.0, C::kOverTension));
    if (reel) t.in.T_reel = 4.5;
    if (!reel) t.in.T_lean = 4.5;
    EXPECT_TRUE(t.run(kDt, C::kOverTension));
    EXPECT_EQ(t.findings.valueOf(C::kOverTension), 4.5);
    t.in.T_reel.reset();
    t.in.T_lean = 1.0;
    EXPECT_FALSE(t.run(1.0, C::kOverTension));
  }
}

TEST(TetherWatch, CommandedNotMovingAndPullingIsASnag) {
  Tether t;
  t.run(6.0, C::kTetherSnagged);
  t.in.length_rate = -0.3;
  EXPECT_FALSE(t.run(3.0, C::kTetherSnagged)) << "it follows";
  EXPECT_FALSE(t.run(1.0, C::kTetherSnagged, 0.0)) << "it does not pull";
  t.in.T_lean = 3.2;
  EXPECT_TRUE(t.run(2.0, C::kTetherSnagged, 0.0));
  t.in.length_rate = 0.0;
  EXPECT_TRUE(t.run(kDt, C::kTetherSnagged, 0.0));
  t.run(10.0, C::kTetherSnagged, 0.0);
  EXPECT_FALSE(t.findings.raised.has(C::kTetherSnagged)) << "nothing is commanded any more";
}

TEST(TetherWatch, AHardPullThatFollowsIsNoSnag) {
  Tether t;
  t.in.T_lean = 3.2;
  t.in.elevation_rate = 0.1;
  EXPECT_FALSE(t.run(4.0, C::kTetherSnagged));
}

TEST(TetherWatch, APullThatGoesWithoutPayOutIsABreak) {
  Tether t;
  t.run(6.0, C::kTetherBroken);
  t.in.T_lean = 0.0;
  EXPECT_FALSE(t.run(1.4, C::kTetherBroken));
  EXPECT_TRUE(t.run(0.3, C::kTetherBroken));
}

TEST(TetherWatch, APullThatGoesBecauseTetherWasPaidOutIsNoBreak) {
  Tether t;
  t.run(6.0, C::kTetherBroken);
  t.in.length_rate = 0.2;
  t.in.T_lean = 0.0;
  EXPECT_FALSE(t.run(5.0, C::kTetherBroken));
  EXPECT_TRUE(t.findings.raised.has(C::kTetherSlack));
}

TEST(TetherWatch, NoPullAfterTakeoffIsNoBreak) {
  Tether t;
  t.in.T_lean = 0.0;
  EXPECT_FALSE(t.run(10.0, C::kTetherBroken)) << "it never pulled";
  EXPECT_TRUE(t.findings.raised.has(C::kTetherSlack));
}

TEST(TetherWatch, TheReelEndsBeforeItsLastMetre) {
  Tether t;
  t.in.L_total = 9.85;
  EXPECT_FALSE(t.run(1.0, C::kReelLimit));
  t.in.L_total = 9.95;
  EXPECT_TRUE(t.run(kDt, C::kReelLimit));
  t.in.flying = false;
  EXPECT_TRUE(t.run(kDt, C::kReelLimit)) << "on the ground too";
}

struct Oscillation {
  OscillationWatch watch{OscillationConfig{}};
  Time now{};
  template <class Motion>
  bool fly(double seconds, const Motion& motion) {
    bool raised = false;
    for (const Time end = now + fromSeconds(seconds); now < end; now += kCycle) {
      Findings out;
      watch.update(now, motion(toSeconds(now.time_since_epoch())), out);
      raised = raised || out.raised.has(C::kOscillation);
    }
    return raised;
  }
};

TEST(OscillationWatch, FindsEveryFrequencyOfTheBand) {
  for (const double hz : {0.35, 0.5, 1.0, 2.0, 3.0}) {
    Oscillation o;
    const auto swing = [hz](double t) {
      return Eigen::Vector3d(0.3 * t, 0.5, 0.3 * std::sin(2.0 * kPi * hz * t));
    };
    EXPECT_TRUE(o.fly(9.0, swing)) << hz << " Hz";
    o.fly(6.0, [](double) { return Eigen::Vector3d::Zero(); });
    EXPECT_FALSE(o.fly(2.0, [](double) { return Eigen::Vector3d::Zero(); })) << hz << " Hz";
  }
}

TEST(OscillationWatch, ACourseWithCornersIsNone) {
  Oscillation o;
  const auto zigzag = [](double t) {
    const double leg = std::fmod(t, 8.0);
    return Eigen::Vector3d(0.3 * (leg < 4.0 ? leg : 8.0 - leg), 1.0, 0.3 * t);
  };
  EXPECT_FALSE(o.fly(60.0, zigzag));
}

TEST(OscillationWatch, NoiseOfTheSensorsIsNone) {
  Oscillation o;
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 0.03);
  EXPECT_FALSE(o.fly(
      60.0, [&](double) { return Eigen::Vector3d(noise(random), noise(random), noise(random)); }));
}

FenceObstacles pillar() {
  FenceObstacle obstacle{.bottom_m = -1.0, .top_m = 3.0};
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(1.0, 1.0), {1.4, 1.0}, {1.4, 1.4}, {1.0, 1.4}})
    obstacle.footprint_zx_m.add(corner);
  FenceObstacles out;
  out.add(obstacle);
  return out;
}

TEST(ContactWatch, EachWitnessSpeaks) {
  const FenceObstacles map = pillar();
  const Eigen::Vector3d beside(0.0, 1.0, 2.0);
  const Eigen::Vector3d behind(2.0, 1.0, 2.0);
  struct Case {
    const char* name;
    ContactWatchInput in;
    double seconds;
    bool raised;
  };
  const ContactWatchInput calm{.flying = true, .usable = true, .p_WD = beside, .nis = 1.0};
  const auto with = [&](auto change) {
    ContactWatchInput in = calm;
    change(in);
    return in;
  };
  const Case cases[] = {
      {"calm", calm, 20.0, false},
      {"behind a pillar of the map", with([&](auto& in) { in.p_WD = behind; }), 1.7, true},
      {"behind it for a moment", with([&](auto& in) { in.p_WD = behind; }), 1.3, false},
      {"innovations", with([](auto& in) { in.nis = 8.0; }), 1.1, true},
      {"higher than it can be", with([](auto& in) { in.height_residual = -1.5; }), 3.0, true},
      {"a barometer's drift", with([](auto& in) { in.height_residual = 0.4; }), 30.0, false},
      {"lost", with([&](auto& in) {
         in.p_WD = behind;
         in.usable = false;
       }),
       5.0, false},
  };
  for (const Case& c : cases) {
    ContactWatch watch(ContactWatchConfig{}, map);
    Findings out;
    for (Time now{}; now < Time{} + fromSeconds(c.seconds); now += kCycle) {
      out = {};
      watch.update(now, c.in, out);
    }
    EXPECT_EQ(out.raised.has(C::kUnplannedContact), c.raised) << c.name;
    for (int i = 0; i < 1000; ++i) {
      out = {};
      watch.update(Time{} + fromSeconds(c.seconds + 0.01 * i), calm, out);
    }
    EXPECT_FALSE(out.raised.has(C::kUnplannedContact)) << c.name << " does not clear";
  }
}

}  // namespace
}  // namespace tautline
