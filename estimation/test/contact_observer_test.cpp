#include "estimation/contact_observer.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "common/testing/malloc_guard.h"

namespace tautline {
namespace {

using Eigen::Vector3d;

constexpr double kCycle = 0.01;    // [s]
constexpr double kMass = 0.6;      // [kg]
constexpr double kGravity = 9.81;  // [m/s^2]
constexpr double kDrag = 0.4;      // [1/s], not what the observer assumes
constexpr double kPull = 0.5;      // [N]
constexpr double kElevation = 0.3;

/// A drone on a straight tether, made of nothing but mechanics: it turns about a pivot at a rate,
/// its acceleration is the second difference of its place, and its thrust is what mechanics ask for
/// that. Angles are quantized and noisy, the air gusts, and so is the lean.
class Swing {
 public:
  explicit Swing(std::uint32_t seed) : random_(seed) {}

  Vector3d pivot{Vector3d::Zero()};
  double L{2.0};      // pivot to drone [m]
  double omega{0.0};  // wanted, of the azimuth [rad/s]
  bool barometer{false};
  double sag{0.0};  // of the tangent over the chord [rad]

  /// Another pivot on the present tether line, `share` of the free length from the drone: the place
  /// and the speed stay.
  void wrap(double share) {
    const Vector3d p = place();
    pivot = p - share * L * direction();
    L *= share;
    rate_ /= share;
  }
  /// The tether goes straight from `from`; the end swings there as fast as a slack one does.
  void comeOff(const Vector3d& from) {
    const Vector3d to = place() - from;
    pivot = from;
    L = to.norm();
    goal_phi_ = std::atan2(to.x(), to.z());
    goal_theta_ = std::asin(to.y() / L);
    coming_off_ = 0.3;
  }

  [[nodiscard]] ContactObserverInput sense(const Anchor& anchor, double L_total) {
    p_before_ = p_now_;
    p_now_ = p_next_;
    advance();
    p_next_ = place();
    if (++cycles_ < 3) p_before_ = p_now_ = p_next_;
    const Vector3d v = (p_next_ - p_before_) / (2.0 * kCycle);
    const Vector3d a = coming_off_ > 0.0
                           ? Vector3d::Zero()
                           : Vector3d((p_next_ - 2.0 * p_now_ + p_before_) / (kCycle * kCycle));
    gust_ += -kCycle / 1.5 * gust_ + 0.03 * std::sqrt(2.0 * kCycle / 1.5) * normal();
    Vector3d sideways(std::cos(phi_), 0.0, -std::sin(phi_));
    const Vector3d force = kMass * (a + kDrag * v + gust_ * sideways) + kPull * direction() +
                           kMass * kGravity * Vector3d::UnitY();
    const Vector3d tilted = force.normalized() + 0.005 * Vector3d(normal(), 0.0, normal());
    ContactObserverInput in;
    in.flying = true;
    in.L_total = L_total;
    in.theta = quantized(theta_ + sag + 0.005 * normal());
    in.sag = sag;
    in.phi = quantized(phi_ + 0.005 * normal());
    in.R_WB = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitY(), tilted);
    in.T = 1.2 * kPull;  // nor is the pull known well
    in.G = kMass * kGravity;
    in.anchor = anchor;
    if (!barometer) return in;
    if (cycles_ % 4 == 0) height_ = place().y() + 0.4 + 0.1 * normal();
    in.height = height_;
    in.height_sequence = static_cast<std::uint32_t>(cycles_ / 4);
    return in;
  }
  [[nodiscard]] Vector3d direction() const {
    return {std::cos(theta_) * std::sin(phi_), std::sin(theta_), std::cos(theta_) * std::cos(phi_)};
  }
  [[nodiscard]] Vector3d place() const { return pivot + L * direction(); }

 private:
  void advance() {
    if (coming_off_ > 0.0) {
      const double share = std::min(1.0, kCycle / coming_off_);
      phi_ += share * (goal_phi_ - phi_);
      theta_ += share * (goal_theta_ - theta_);
      coming_off_ -= kCycle;
      return;
    }
    rate_ += kCycle / 0.4 * (omega - rate_);
    phi_ += kCycle * rate_;
  }
  [[nodiscard]] double normal() { return normal_(random_); }
  static double quantized(double angle) { return std::round(angle / 0.01) * 0.01; }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  double theta_{kElevation};
  double phi_{0.2};
  double rate_{0.0};
  double gust_{0.0};
  double goal_phi_{0.0};
  double goal_theta_{0.0};
  double coming_off_{0.0};
  int cycles_{0};
  double height_{0.0};  // barometric, of the last reading, off by what nobody knows
  Vector3d p_before_{Vector3d::Zero()};
  Vector3d p_now_{Vector3d::Zero()};
  Vector3d p_next_{Vector3d::Zero()};
};

struct Watched {
  ContactObserver observer{ContactObserverConfig{}};
  Time now{};
  ContactVerdict verdict;

  /// Seconds until something other than kHolds is found; absent: not within `limit`.
  std::optional<double> watch(Swing& swing, const Anchor& anchor, double L_total, double limit) {
    for (double t = 0.0; t < limit; t += kCycle) {
      now += fromSeconds(kCycle);
      verdict = observer.update(now, swing.sense(anchor, L_total));
      if (verdict.hypothesis != TetherHypothesis::kHolds) return t;
    }
    return std::nullopt;
  }
};

/// To and fro, as a mission does.
void wander(Swing& swing, double t) { swing.omega = std::fmod(t, 8.0) < 4.0 ? 0.15 : -0.15; }

TEST(ContactObserver, NoFalseAlarmInHoursOfQuantizedNoise) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    Swing swing(seed);
    Watched w;
    for (int second = 0; second < 3600; ++second) {
      wander(swing, second);
      ASSERT_EQ(w.watch(swing, Anchor{}, swing.L, 1.0), std::nullopt) << second;
    }
  }
}

TEST(ContactObserver, FindsAContactThatNobodyPlannedAndWhereItIs) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    Swing swing(seed);
    Watched w;
    const double L_total = 3.0;
    swing.L = L_total;
    swing.omega = 0.1;
    ASSERT_EQ(w.watch(swing, Anchor{}, L_total, 8.0), std::nullopt);
    swing.wrap(0.35);
    swing.omega = 0.1 / 0.35;  // the drone flies on as fast as before
    const auto delay = w.watch(swing, Anchor{}, L_total, 5.0);
    ASSERT_TRUE(delay) << seed;
    EXPECT_LE(*delay, 1.0) << seed;
    EXPECT_EQ(w.verdict.hypothesis, TetherHypothesis::kUnplanned) << seed;
    EXPECT_NEAR(w.verdict.lever, swing.L, 1.3) << seed;
    EXPECT_LT((w.verdict.p_WC - swing.pivot).norm(), 1.4) << seed;
  }
}

/// On the line of the tether, 2 m from the reel.
Anchor contactOn(const Swing& swing, double L_static) {
  return {.p_WA = L_static * swing.direction(), .L_static = L_static, .contact_count = 1};
}

TEST(ContactObserver, FindsThatAPlannedContactIsNotThere) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    Swing swing(seed);
    Watched w;
    const double L_total = 3.0;
    swing.L = L_total;
    swing.omega = 0.1;
    ASSERT_EQ(w.watch(swing, Anchor{}, L_total, 8.0), std::nullopt);
    const Anchor anchor = contactOn(swing, 2.0);
    swing.omega = 0.3;  // what the shorter lever needs for the same speed
    const auto delay = w.watch(swing, anchor, L_total, 5.0);
    ASSERT_TRUE(delay) << seed;
    EXPECT_LE(*delay, 1.2) << seed;
    EXPECT_EQ(w.verdict.hypothesis, TetherHypothesis::kNotFormed) << seed;
    EXPECT_NEAR(w.verdict.lever, L_total, 1e-9) << seed;
  }
}

TEST(ContactObserver, AContactThatFormsIsBelievedAndItsLossIsTold) {
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    Swing swing(seed);
    Watched w;
    const double L_total = 3.0;
    swing.L = L_total;
    swing.omega = 0.1;
    ASSERT_EQ(w.watch(swing, Anchor{}, L_total, 8.0), std::nullopt);
    const Anchor anchor = contactOn(swing, 2.0);
    swing.wrap(1.0 / 3.0);
    for (int i = 0; i < 6; ++i) {
      swing.omega = i % 2 == 0 ? 0.3 : -0.1;
      ASSERT_EQ(w.watch(swing, anchor, L_total, 1.5), std::nullopt) << seed << " " << i;
    }
    swing.comeOff(Vector3d::Zero());
    const auto delay = w.watch(swing, anchor, L_total, 5.0);
    ASSERT_TRUE(delay) << seed;
    EXPECT_LE(*delay, 1.0) << seed;
    EXPECT_EQ(w.verdict.hypothesis, TetherHypothesis::kLost) << seed;
  }
}

TEST(ContactObserver, ASlipAlongAnUprightEdgeIsToldWithItsSize) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    for (const double slip : {0.3, -0.3}) {
      Swing swing(seed);
      swing.barometer = true;
      swing.sag = 0.08;
      Watched w;
      const double L_total = 3.0;
      swing.L = L_total;
      swing.omega = 0.1;
      ASSERT_EQ(w.watch(swing, Anchor{}, L_total, 8.0), std::nullopt);
      const Anchor anchor = contactOn(swing, 2.0);
      swing.wrap(1.0 / 3.0);
      swing.omega = 0.3;
      ASSERT_EQ(w.watch(swing, anchor, L_total, 5.0), std::nullopt) << seed;
      double told = -1.0;
      for (int i = 0; i < 300; ++i) {
        if (i < 50) swing.pivot.y() += slip / 50.0;
        if (w.watch(swing, anchor, L_total, kCycle) && told < 0.0) told = i * kCycle;
      }
      EXPECT_GT(told, 0.0) << seed;
      EXPECT_LE(told, 1.5) << seed;
      EXPECT_EQ(w.verdict.hypothesis, TetherHypothesis::kSlipped) << seed;
      EXPECT_NEAR(w.verdict.slip, slip, 0.12) << seed;
      const Anchor next{.p_WA = anchor.p_WA, .L_static = anchor.L_static, .contact_count = 2};
      EXPECT_EQ(w.watch(swing, next, L_total, 3.0), std::nullopt) << "made anew where it is";
    }
  }
}

TEST(ContactObserver, ABarometerIsNoAlarmByItself) {
  for (std::uint32_t seed = 1; seed <= 3; ++seed) {
    Swing swing(seed);
    swing.barometer = true;
    Watched w;
    const double L_total = 3.0;
    swing.L = L_total;
    ASSERT_EQ(w.watch(swing, Anchor{}, L_total, 8.0), std::nullopt);
    Anchor anchor = contactOn(swing, 2.0);
    swing.wrap(1.0 / 3.0);
    for (int second = 0; second < 3600; ++second) {
      wander(swing, second);
      if (second % 20 == 0) anchor.contact_count = 1 + second % 40 / 20;
      ASSERT_EQ(w.watch(swing, anchor, L_total, 1.0), std::nullopt) << second;
    }
  }
}

TEST(ContactObserver, AContactMayHoldOnForAMomentAfterItWasLetGo) {
  Swing swing(1);
  Watched w;
  const double L_total = 3.0;
  swing.L = L_total;
  swing.omega = 0.1;
  ASSERT_EQ(w.watch(swing, Anchor{}, L_total, 8.0), std::nullopt);
  const Anchor anchor = contactOn(swing, 2.0);
  swing.wrap(1.0 / 3.0);
  swing.omega = 0.3;
  ASSERT_EQ(w.watch(swing, anchor, L_total, 3.0), std::nullopt);
  swing.omega = -0.1;
  EXPECT_EQ(w.watch(swing, Anchor{}, L_total, 2.0), std::nullopt);
}

TEST(ContactObserver, NothingIsSaidOnTheGroundAndOfNonsense) {
  Swing swing(1);
  ContactObserver observer{ContactObserverConfig{}};
  const testing::MallocGuard guard;
  Time now{};
  for (int i = 0; i < 2000; ++i) {
    ContactObserverInput in = swing.sense(Anchor{}, 2.0);
    swing.omega = i < 1000 ? 0.0 : 1.0;
    in.L_total = 5.0;
    in.flying = false;
    if (i % 3 == 1) in.phi = std::numeric_limits<double>::quiet_NaN();
    if (i % 3 == 2) in.flying = true, in.theta = std::numeric_limits<double>::infinity();
    now += fromSeconds(i % 5 == 0 ? -kCycle : kCycle);
    EXPECT_EQ(observer.update(now, in).hypothesis, TetherHypothesis::kHolds);
  }
  if (testing::MallocGuard::available()) {
    EXPECT_EQ(guard.allocations(), 0);
  }
}

}  // namespace
}  // namespace tautline
