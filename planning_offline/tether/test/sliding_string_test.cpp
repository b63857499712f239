#include "planning_offline/tether/sliding_string.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "planning_offline/tether/test/prism.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

TEST(SlidingString, IsTheShortestOfItsHomotopyClassAmongPrisms) {
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    const PrismWalk walk = prismWalk(seed, 40);
    SlidingString string(walk.map, walk.points.front());
    for (std::size_t i = 1; i < walk.points.size(); ++i) {
      string.moveTo(walk.points[i]);
      if (i % 4 != 0) continue;
      const PrismString wanted = shortestAmongPrisms(walk, i);
      ASSERT_NEAR(string.length(), wanted.length, 1e-4) << "seed " << seed << " step " << i;
      const std::vector<Eigen::Vector3d> got = string.contacts();
      ASSERT_EQ(got.size(), wanted.contacts.size()) << "seed " << seed << " step " << i;
      for (std::size_t k = 0; k < got.size(); ++k) {
        ASSERT_LE((got[k] - wanted.contacts[k]).norm(), 1e-3) << "seed " << seed << " step " << i;
      }
      contacts += static_cast<int>(got.size());
    }
    ASSERT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
  }
  EXPECT_GT(contacts, 10000);
}

}  // namespace
}  // namespace tautline::planning
