// What faults do to reel, tether, vehicle and air, against what mechanics says.

#include <cmath>

#include <gtest/gtest.h>

#include "sim_hil/fault.h"
#include "sim_hil/test/flight_rig.h"

namespace tautline::sim {
namespace {

constexpr double kG = 9.81;
constexpr double kMass = 0.618;
constexpr double kCount = 0.00285;  // [m]

class Flight : public ::testing::Test {
 protected:
  void SetUp() override { rig_.takeOff(); }

  /// From now on.
  void inject(const std::string& target, const std::string& mode, double for_s, double value) {
    Fault f = makeFault(target, mode);
    f.at = rig_.plant().now();
    f.lasting = fromSeconds(for_s);
    f.value = value;
    ASSERT_TRUE(rig_.plant().faults().add(f));
  }
  void inject(const std::string& target, const std::string& mode, double for_s = 1000.0) {
    inject(target, mode, for_s, makeFault(target, mode).value);
  }
  void drive(double speed) {
    reel().lock(false);
    reel().command(speed / kCount);
  }
  Reel& reel() { return rig_.plant().reel(); }
  const Truth& truth() const { return rig_.truth(); }

  FlightRig rig_;
};

TEST_F(Flight, ReelOffStandsAndFollowsAgain) {
  inject("reel", "off", 2.0);
  const double before = truth().length;
  drive(0.2);
  rig_.run(2.0);
  EXPECT_NEAR(truth().length, before, 1e-3);
  rig_.run(2.0);
  EXPECT_NEAR(truth().length, before + 0.2 * 1.9, 0.01);
}

TEST_F(Flight, ReelStuckRunsOnAsLastCommanded) {
  drive(0.2);
  rig_.run(1.0);
  inject("reel", "stuck");
  reel().lock(true);
  const double before = truth().length;
  rig_.run(2.0);
  EXPECT_NEAR(truth().length, before + 0.4, 0.01);
}

TEST_F(Flight, ReelWrongTurnsTheOtherWay) {
  inject("reel", "wrong", 1000.0, -1.0);
  const double before = truth().length;
  drive(0.2);
  rig_.run(1.0);
  EXPECT_NEAR(truth().length, before - 0.2 * 0.9, 0.01);
}

TEST_F(Flight, ReelSlowIsLimited) {
  inject("reel", "slow", 1000.0, 0.05);
  const double before = truth().length;
  drive(0.2);
  rig_.run(2.0);
  EXPECT_NEAR(truth().length, before + 0.05 * 1.9, 0.005);
}

TEST_F(Flight, ReelDelayedFollowsLate) {
  inject("reel", "delayed", 1000.0, 0.5);
  const double before = truth().length;
  rig_.run(1.0);
  drive(0.2);
  rig_.run(0.5);
  EXPECT_NEAR(truth().length, before, 1e-3);
  rig_.run(1.0);
  EXPECT_NEAR(truth().length, before + 0.2 * 0.9, 0.01);
}

TEST_F(Flight, ReelIntermittentDoesAboutHalf) {
  inject("reel", "intermittent", 1000.0, 0.3);
  const double before = truth().length;
  drive(0.1);
  rig_.run(20.0);
  EXPECT_GT(truth().length - before, 0.2 * 2.0);
  EXPECT_LT(truth().length - before, 0.8 * 2.0);
}

TEST_F(Flight, ReelGarbageTurnsBothWaysWithinItsLimit) {
  inject("reel", "garbage", 1000.0, 0.3);
  double least = 0.0;
  double most = 0.0;
  reel().lock(true);
  rig_.run(10.0, [&] {
    least = std::fmin(least, reel().rate());
    most = std::fmax(most, reel().rate());
  });
  EXPECT_LT(least, -0.1);
  EXPECT_GT(most, 0.1);
  EXPECT_GE(least, -0.3);
  EXPECT_LE(most, 0.3);
}

TEST_F(Flight, SlackPaysOutWithoutBeingAskedAndTheEncoderSeesIt) {
  inject("reel", "slack", 1000.0, 0.2);
  const double before = truth().length;
  const std::int64_t counts = reel().counts();
  rig_.run(2.0);
  EXPECT_NEAR(truth().length, before + 0.2 * 1.9, 0.01);
  EXPECT_NEAR(static_cast<double>(reel().counts() - counts) * kCount, 0.2 * 1.9, 0.01);
}

TEST_F(Flight, PayoutSlipCountsMoreThanFollows) {
  inject("reel", "payout_slip", 1000.0, 0.5);
  const double before = truth().length;
  const std::int64_t counts = reel().counts();
  drive(0.2);
  rig_.run(2.0);
  const double counted = static_cast<double>(reel().counts() - counts) * kCount;
  EXPECT_NEAR(counted, 0.2 * 1.9, 0.01);
  EXPECT_NEAR(truth().length - before, 0.5 * counted, 0.005);
}

TEST_F(Flight, SnagHoldsTheTetherWhileTheDrumTurns) {
  inject("tether", "snag", 5.0, 0.0);
  const double before = truth().length;
  const std::int64_t counts = reel().counts();
  drive(0.2);
  rig_.run(2.0);
  EXPECT_NEAR(truth().length, before, 1e-9) << "the free length does not follow";
  EXPECT_NEAR(static_cast<double>(reel().counts() - counts) * kCount, 0.2 * 1.9, 0.01);
  // Winding in: first what was paid out, then against the held tether with all the drum's force.
  drive(-0.2);
  rig_.run(2.9);
  EXPECT_NEAR(truth().length, before, 1e-9);
  EXPECT_NEAR(reel().length(), before, 1e-3);
  EXPECT_NEAR(truth().reel_tension, ReelConfig{}.slip_tension, 1e-9);
  reel().lock(true);
  rig_.run(1.0);
  EXPECT_NEAR(truth().length, reel().length(), 1e-9) << "free again";
}

TEST_F(Flight, SnagLetsTheTetherFollowItsReelWhenItEnds) {
  inject("tether", "snag", 2.0, 0.0);
  const double before = truth().length;
  drive(0.2);
  rig_.run(2.0);
  reel().lock(true);
  rig_.run(1.0);
  EXPECT_NEAR(truth().length, reel().length(), 1e-9);
  EXPECT_NEAR(truth().length, before + 0.2 * 2.0, 0.03);
}

TEST_F(Flight, SnagHalfWayHoldsThatPointOfTheTether) {
  inject("tether", "snag", 1000.0, 0.5);
  const Eigen::Vector3d held = rig_.plant().tether().position(12);
  const Eigen::Vector3d drone = truth().p_WD;
  rig_.rates(0.0, 0.2);
  rig_.run(3.0);
  EXPECT_LT((rig_.plant().tether().position(12) - held).norm(), 1e-3);
  EXPECT_GT((truth().p_WD - drone).norm(), 0.1);
  EXPECT_LE((truth().p_WD - held).norm(), 0.5 * truth().length + 0.01) << "half of it is left";
}

TEST_F(Flight, BrokenTetherCarriesNothingAndHoldsNothing) {
  inject("tether", "break");
  rig_.run(3.0);
  const double half_link = 0.5 * 0.0061 * kG * truth().length / 24.0;
  EXPECT_NEAR(truth().tension, half_link, 1e-6);
  EXPECT_GT(truth().p_WD.norm(), truth().length + 0.2) << "farther than the tether was long";
  const double length = truth().length;
  drive(-0.2);
  rig_.run(1.0);
  EXPECT_EQ(truth().length, length);
}

TEST_F(Flight, OverTensionIsFeltAtTheDrone) {
  rig_.run(2.0);
  const double before = truth().tension;
  inject("tether", "over_tension", 5.0, 5.0);
  rig_.run(4.0);
  EXPECT_NEAR(truth().tension - before, 4.0, 0.25) << "5 N instead of its own 1 N";
  rig_.run(5.0);
  EXPECT_NEAR(truth().tension, before, 0.1);
}

TEST_F(Flight, MotorsOffIsFreeFall) {
  rig_.run(1.0);
  const double height = truth().p_WD.y();
  inject("motors", "off");
  rig_.run(0.3);
  EXPECT_NEAR(height - truth().p_WD.y(), 0.5 * kG * 0.3 * 0.3, 0.03);
}

TEST_F(Flight, WeakMotorsCannotCarryTheWeight) {
  const double height = truth().p_WD.y();
  inject("motors", "motor_weak", 1000.0, 0.4);
  double most = 0.0;
  rig_.run(0.3);
  rig_.run(0.4, [&] { most = std::fmax(most, rig_.plant().vehicle().thrust().norm()); });
  EXPECT_LE(most, 0.4 * 12.0 + 0.01);
  // At most 4.8 N carry more than 6.06 N: it sinks, though the motors do what they can.
  const double least_sink = 0.5 * (kG - 4.8 / kMass) * 0.5 * 0.5;
  EXPECT_GT(height - truth().p_WD.y(), least_sink);
}

TEST_F(Flight, GustPushesWithItsDrag) {
  rig_.run(2.0);
  const Eigen::Vector3d v = truth().v_WD;
  Fault gust = parseFault("air gust 0 1000 5,0,0");
  gust.at = rig_.plant().now();
  ASSERT_TRUE(rig_.plant().faults().add(gust));
  rig_.run(0.1);
  EXPECT_EQ(truth().gust, Eigen::Vector3d(5.0, 0.0, 0.0));
  const double push = 0.2 * 5.0 / kMass * 0.1;  // linear drag, before the vehicle leans against it
  EXPECT_NEAR(truth().v_WD.x() - v.x(), push, 0.2 * push);
}

TEST_F(Flight, NothingRemainsOfAFaultThatIsOver) {
  FlightRig other;
  other.takeOff();
  inject("encoder", "stuck", 1.0);
  inject("clock", "slow", 1.0, 0.5);
  rig_.run(5.0);
  other.run(5.0);
  EXPECT_EQ(truth().p_WD, other.truth().p_WD) << "neither touches the machine's motion";
  EXPECT_NEAR(toSeconds(rig_.plant().now() - rig_.plant().clock()), 0.5, 0.01);
}

/// A tether round the edge of a pillar, its end at `target`, drawn there by a spring.
struct Bent {
  Bent() {
    scene.floor = -3.0;
    scene.boxes.push_back({"pillar", {0.5, -2.0, 1.0}, {0.9, 3.0, 1.4}});
    obstacles = Obstacles(scene);
    config.density = 1e-3;
  }
  void draw(TetherChain& chain, const Eigen::Vector3d& target, double seconds, double* L) {
    for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
      EndLoad end;
      end.force = 40.0 * (target - chain.position(24)) - 6.0 * chain.velocity(24);
      if (L != nullptr) *L = length(target) - 0.01;
      chain.step(0.002, L != nullptr ? *L : chain.length(), end, Eigen::Vector3d::Zero(),
                 obstacles);
    }
  }
  static double length(const Eigen::Vector3d& p) {
    const Eigen::Vector2d corner(0.5, 1.4);
    const bool bent = std::atan2(p.x(), p.z()) > std::atan2(0.5, 1.4);
    const double flat = bent ? corner.norm() + (Eigen::Vector2d(p.x(), p.z()) - corner).norm()
                             : std::hypot(p.x(), p.z());
    return std::hypot(flat, p.y());
  }
  Scene scene;
  Obstacles obstacles;
  TetherConfig config;
};

TEST(ContactFaults, WithoutFrictionTheContactSlidesToTheShortestWay) {
  Bent bent;
  bent.config.friction = 1.5;
  const Eigen::Vector3d a(0.0, 0.2, 2.0);
  const Eigen::Vector3d b(1.6, 0.2, 1.8);
  TetherChain chain(bent.config, a, a.norm());
  double L = a.norm();
  for (int k = 1; k <= 20; ++k) bent.draw(chain, a + k / 20.0 * (b - a), 0.2, &L);
  ASSERT_EQ(chain.bends().size(), 1U);
  const Eigen::Vector3d up(1.6, 1.0, 1.8);
  for (int k = 1; k <= 10; ++k) bent.draw(chain, b + k / 10.0 * (up - b), 0.2, &L);
  ASSERT_EQ(chain.bends().size(), 1U);
  const double stuck = chain.bends()[0].point().y();
  TetherDisturbance disturbance;
  disturbance.friction = 0.0;
  chain.disturb(disturbance);
  bent.draw(chain, up, 3.0, &L);
  ASSERT_EQ(chain.bends().size(), 1U);
  const Eigen::Vector3d p = chain.position(24);
  const double before = std::hypot(0.5, 1.4);
  const double after = std::hypot(p.x() - 0.5, p.z() - 1.4);
  // Unfolded at the edge, the shortest way is a straight line from the outlet to the end.
  EXPECT_NEAR(chain.bends()[0].point().y(), p.y() * before / (before + after), 0.03);
  EXPECT_GT(std::abs(chain.bends()[0].point().y() - stuck), 0.05) << "it had been held by friction";
}

TEST(ContactFaults, ATetherThatLetsGoIsStraightAgain) {
  Bent bent;
  const Eigen::Vector3d a(0.0, 0.2, 2.0);
  const Eigen::Vector3d b(1.6, 0.2, 1.8);
  TetherChain chain(bent.config, a, a.norm());
  double L = a.norm();
  for (int k = 1; k <= 20; ++k) bent.draw(chain, a + k / 20.0 * (b - a), 0.2, &L);
  ASSERT_EQ(chain.bends().size(), 1U);
  const double held = chain.position(24).norm();
  TetherDisturbance disturbance;
  disturbance.no_contacts = true;
  chain.disturb(disturbance);
  bent.draw(chain, (chain.length() + 0.05) * b.normalized(), 3.0, nullptr);
  EXPECT_TRUE(chain.bends().empty());
  EXPECT_NEAR(chain.position(24).norm(), chain.length(), 0.02);
  EXPECT_GT(chain.position(24).norm(), held + 0.02);
}

}  // namespace
}  // namespace tautline::sim
