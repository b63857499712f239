#include "planning_offline/tether/hanging_contacts.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "planning_offline/tether/contact_plan.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

constexpr double kWeight = 0.06;  // [N/m]

TEST(HangingContacts, HeightIsThatOfTheSymmetricCatenary) {
  // From (−b, y) to (b, y): y = a cosh(x/a), so the tension at the end is w a cosh(b/a).
  for (const double b : {0.3, 1.0, 2.5}) {
    for (const double a : {2.0, 5.0, 50.0}) {
      if (b > a) continue;  // steeper ones are not the taut shape
      const HangingTether tether{kWeight, kWeight * a * std::cosh(b / a)};
      const Eigen::Vector3d anchor(-0.6 * b, 1.0, -0.8 * b);
      const Eigen::Vector3d vehicle(0.6 * b, 1.0, 0.8 * b);
      for (const double part : {-0.9, -0.2, 0.0, 0.5}) {
        const Eigen::Vector3d contact(0.6 * b * part, 1.0, 0.8 * b * part);
        const double height = 1.0 + a * (std::cosh(part * b / a) - std::cosh(b / a));
        EXPECT_NEAR(heightPassed(tether, anchor, contact, vehicle), height, 1e-9);
      }
    }
  }
}

TEST(HangingContacts, StaysWhereItCannotHang) {
  const Eigen::Vector3d anchor(0, 0, 0), contact(1, 0.4, 0), vehicle(2, 1, 0);
  EXPECT_EQ(heightPassed({0.0, 1.0}, anchor, contact, vehicle), 0.4);       // without weight
  EXPECT_EQ(heightPassed({kWeight, 0.01}, anchor, contact, vehicle), 0.4);  // no static shape
  EXPECT_EQ(heightPassed({kWeight, 1.0}, anchor, vehicle, contact), 1.0);   // not between
}

/// A pillar of one cell through the whole height, the reel before it, and a way past it.
class UprightPillar : public ::testing::Test {
 protected:
  UprightPillar() {
    map_.resolution = 0.3;
    for (int y = 0; y < 10; ++y) walks::occupy(map_, {4, y, 4});
  }
  [[nodiscard]] Eigen::Vector3d at(double x, double y, double z) const {
    return map_.origin + map_.resolution * Eigen::Vector3d(x, y, z);
  }
  VoxelMap map_{walks::emptyMap({10, 10, 10})};
  Eigen::Vector3d reel_{at(0.5, 0.5, 0.5)};
  std::vector<Eigen::Vector3d> path_{at(9, 6, 2), at(9, 6, 6), at(8, 6, 9), at(9, 6, 6),
                                     at(9, 6, 2)};
};

TEST_F(UprightPillar, LowersTheContactAndAllLengths) {
  const ContactPlan straight = planContacts(map_, reel_, path_);
  ContactPlan hanging = straight;
  hangContacts(map_, reel_, {kWeight, 0.6}, hanging);
  ASSERT_EQ(straight.states.size(), hanging.states.size());
  int lowered = 0;
  for (std::size_t i = 0; i < straight.states.size(); ++i) {
    const TetherState& before = straight.states[i];
    const TetherState& after = hanging.states[i];
    ASSERT_EQ(before.contacts.size(), after.contacts.size());
    ASSERT_EQ(before.events.size(), after.events.size());
    double length = 0.0;
    Eigen::Vector3d last = reel_;
    for (std::size_t c = 0; c < after.contacts.size(); ++c) {
      const Eigen::Vector3d drop = before.contacts[c] - after.contacts[c];
      EXPECT_EQ(drop.x(), 0.0);
      EXPECT_EQ(drop.z(), 0.0);
      EXPECT_GT(drop.y(), 0.02) << "state " << i << " contact " << c << " at "
                                << before.contacts[c].transpose() << " drone "
                                << before.position.transpose();
      EXPECT_LT(drop.y(), 0.6);
      lowered += 1;
      length += (after.contacts[c] - last).norm();
      last = after.contacts[c];
    }
    EXPECT_NEAR(after.length, length + (after.position - last).norm(), 1e-12);
  }
  EXPECT_GT(lowered, 0);
}

TEST_F(UprightPillar, ATautOneIsWhereTheStraightOneIs) {
  const ContactPlan straight = planContacts(map_, reel_, path_);
  ContactPlan hanging = straight;
  hangContacts(map_, reel_, {kWeight, 1000.0}, hanging);
  for (std::size_t i = 0; i < straight.states.size(); ++i)
    for (std::size_t c = 0; c < straight.states[i].contacts.size(); ++c)
      EXPECT_LT((straight.states[i].contacts[c] - hanging.states[i].contacts[c]).norm(), 1e-3);
}

TEST(HangingContacts, ALevelEdgeKeepsItsContact) {
  VoxelMap map = walks::emptyMap({10, 10, 10});
  for (int z = 0; z < 10; ++z)
    for (int y = 0; y < 4; ++y) walks::occupy(map, {4, y, z});
  const auto at = [&](double x, double y, double z) {
    return Eigen::Vector3d(map.origin + map.resolution * Eigen::Vector3d(x, y, z));
  };
  const Eigen::Vector3d reel = at(0.5, 0.5, 5.3);
  const std::vector<Eigen::Vector3d> path{at(0.7, 8, 5.3), at(8, 8, 5.3), at(8, 2, 5.3)};
  const ContactPlan straight = planContacts(map, reel, path);
  ContactPlan hanging = straight;
  hangContacts(map, reel, {kWeight, 0.3}, hanging);
  ASSERT_FALSE(straight.states.back().contacts.empty());
  for (std::size_t c = 0; c < straight.states.back().contacts.size(); ++c)
    EXPECT_EQ(straight.states.back().contacts[c], hanging.states.back().contacts[c]);
}

}  // namespace
}  // namespace tautline::planning
