#include "planning_offline/tether/published_contacts.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/mission/test/test_problem.h"
#include "planning_offline/field/line_of_sight.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/tether/compare_contacts.h"
#include "planning_offline/tether/test/published_kit.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

/// A point in M that is given in cells.
Eigen::Vector3d at(const VoxelMap& map, const Eigen::Vector3d& cells) {
  return map.origin + map.resolution * cells;
}
Eigen::Vector3d at(const VoxelMap& map, double x, double z) { return at(map, {x, 0.5, z}); }

void expectPoints(const Points& points, const Points& expected) {
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((points[i] - expected[i]).norm(), 1e-9) << i << ": " << points[i].transpose();
  }
}

// ---- one look a waypoint ----------------------------------------------------------------------

/// A block and a reel to the left of it; the vehicle comes over its upper side.
struct Block {
  VoxelMap map = drawnMap({"......", "......", "..##..", "......", "......"});
  Eigen::Vector3d reel = at(map, 0.5, 2.5);
  Eigen::Vector3d above = at(map, 4.5, 0.5);
  Eigen::Vector3d behind = at(map, 4.5, 2.4);
  Eigen::Vector3d left = at(map, 2, 2);  // upper corners of the block
  Eigen::Vector3d right = at(map, 4, 2);
};

TEST(PublishedContacts, AddsOneContactAWaypointAndDoesNotLookAgain) {
  const Block block;
  const Points path{block.above, block.behind, block.behind};
  const ContactComparison both = compareContacts(block.map, block.reel, path, kIdeal);
  expectPoints(both.rows[0].published.contacts, {});
  expectPoints(both.rows[1].exact.contacts, {block.left, block.right});
  expectPoints(both.rows[1].published.contacts, {block.left});
  EXPECT_TRUE(both.rows[1].published.pierces);
  EXPECT_LT(both.rows[1].published.length, both.rows[1].exact.length - 1e-3);
  expectPoints(both.rows[2].published.contacts, {block.left, block.right});
  EXPECT_FALSE(both.rows[2].published.pierces);
  EXPECT_NEAR(both.rows[2].published.length, both.rows[2].exact.length, 1e-9);
}

TEST(PublishedContacts, RelaxesOneContactAWaypoint) {
  const Block block;
  const Points path{block.above, block.behind, block.behind, block.above, block.above};
  const ContactComparison both = compareContacts(block.map, block.reel, path, kIdeal);
  expectPoints(both.rows[3].exact.contacts, {});
  expectPoints(both.rows[3].published.contacts, {block.left});
  EXPECT_GT(both.rows[3].published.length, both.rows[3].exact.length + 1e-3);
  expectPoints(both.rows[4].published.contacts, {});
}

TEST(PublishedContacts, KeepsAContactWhileAnObstacleIsConfined) {
  const Block block;
  // At the end the reel is in sight below the block; the tether still lies over its upper side.
  const Points path{block.above, block.behind, at(block.map, 4.5, 4.0)};
  const ContactComparison both = compareContacts(block.map, block.reel, path, kIdeal);
  EXPECT_TRUE(lineOfSight(block.map.shape, obstacleCells(block.map, false),
                          inCells(block.map, block.reel), inCells(block.map, path[2])));
  expectPoints(both.rows[2].exact.contacts, {block.left, block.right});
  expectPoints({both.rows[2].published.contacts.at(0)}, {block.left});
  EXPECT_TRUE(both.rows[2].published.relaxation_refused);
  EXPECT_FALSE(both.rows[1].published.relaxation_refused);  // there the line is blocked
  // A reading under which nothing in the plane is confined lets the tether through the block.
  PublishedOptions options = kIdeal;
  options.confinement = Confinement::kCentreInside;
  const auto states = publishedContacts(block.map, block.reel, path, options);
  expectPoints(states[2].contacts, {});
  EXPECT_FALSE(states[2].relaxation_refused);
}

TEST(PublishedContacts, MissesWhatTheTetherSweptBetweenTwoWaypoints) {
  const VoxelMap map = drawnMap({".......", ".......", "...#...", ".......", "......."});
  const Points path{at(map, 6.5, 0.5), at(map, 6.5, 4.5)};
  const ContactComparison both = compareContacts(map, at(map, 0.5, 2.5), path, kIdeal);
  expectPoints(both.rows[1].exact.contacts, {at(map, 3, 2), at(map, 4, 2)});
  expectPoints(both.rows[1].published.contacts, {});
  EXPECT_FALSE(both.rows[1].published.pierces);
  EXPECT_LT(both.rows[1].published.length, both.rows[1].exact.length - 0.1);
}

TEST(PublishedContacts, KeepsTheOldContactWhereItShouldSwitchToTheBlockingCorner) {
  const VoxelMap map = drawnMap(
      {".......", ".......", "....#..", ".......", ".......", "...#...", ".......", "......."});
  const Points path{at(map, 6.5, 4.5), at(map, 6.5, 6.2), at(map, 6.5, 7.5), at(map, 5.5, 0.5)};
  const ContactComparison both = compareContacts(map, at(map, 0.5, 4.5), path, kIdeal);
  expectPoints(both.rows[2].exact.contacts, {at(map, 4, 5)});
  expectPoints(both.rows[2].published.contacts, {at(map, 4, 5)});
  expectPoints(both.rows[3].exact.contacts, {at(map, 5, 3)});
  EXPECT_TRUE(both.rows[3].published.relaxation_refused);
  ASSERT_EQ(both.rows[3].published.contacts.size(), 2U);
  expectPoints({both.rows[3].published.contacts[0]}, {at(map, 4, 5)});
  EXPECT_GT(both.rows[3].published.length, both.rows[3].exact.length + 0.1);
}

TEST(PublishedContacts, PutsAContactOnTheWrongEndOfAWall) {
  const VoxelMap map =
      drawnMap({".........", ".........", ".........", "..#####..", ".........", "........."});
  const Points path{at(map, 8.5, 5.0), at(map, 7.5, 0.5)};
  PublishedOptions options = kIdeal;
  const auto contacts = [&](ContactPlacement placement) {
    options.placement = placement;
    const ContactComparison both = compareContacts(map, at(map, 0.5, 5.5), path, options);
    expectPoints(both.rows[1].exact.contacts, {at(map, 7, 4)});
    EXPECT_GT(std::abs(both.rows[1].published.length - both.rows[1].exact.length), 0.1);
    return both.rows[1].published;
  };
  // The line enters the wall near its left end; the vehicle went round the right one.
  const TetherState nearest = contacts(ContactPlacement::kNearestEdge);
  expectPoints(nearest.contacts, {at(map, 2, 4)});
  EXPECT_TRUE(nearest.pierces);
  const TetherState corner = contacts(ContactPlacement::kCorner);
  expectPoints(corner.contacts, {at(map, 2, 3)});
  EXPECT_FALSE(corner.pierces);  // free, but on the wrong side for good
}

TEST(PublishedContacts, FollowingWaypointsGetTheChangeOneLater) {
  const Block block;
  const Points path{block.above, block.behind, block.behind, block.above, block.above, block.above};
  PublishedOptions options = kIdeal;
  const auto now = publishedContacts(block.map, block.reel, path, options);
  options.attachment = Attachment::kFollowingWaypoint;
  const auto later = publishedContacts(block.map, block.reel, path, options);
  expectPoints(later[0].contacts, {});
  for (std::size_t i = 1; i < path.size(); ++i)
    expectPoints(later[i].contacts, now[i - 1].contacts);
  EXPECT_TRUE(later[1].pierces);  // the stale tether, straight through the block
  EXPECT_FALSE(later[4].pierces);
  EXPECT_EQ(later[4].contacts.size(), 1U);
}

TEST(PublishedContacts, SamplesMissWhatIsThinnerThanAStep) {
  const VoxelMap map = drawnMap({"....", "..#.", "...."});
  const Eigen::Vector3d reel = at(map, 0.5, 0.5);
  // Inside the block's lower left corner for 0.04 cells.
  const Points path{at(map, 2.5, 2.46)};
  PublishedOptions options = kIdeal;
  EXPECT_EQ(publishedContacts(map, reel, path, options)[0].contacts.size(), 1U);
  options.sample_step = 1.0;
  const auto coarse = publishedContacts(map, reel, path, options);
  EXPECT_TRUE(coarse[0].contacts.empty());
  EXPECT_TRUE(coarse[0].pierces);
}

// ---- where contacts are put -------------------------------------------------------------------

TEST(PublishedContacts, EntryLeavesTheContactInsideSoThatEveryWaypointCollidesAgain) {
  const Block block;
  PublishedOptions options = kIdeal;
  options.placement = ContactPlacement::kEntry;
  const Points path(6, block.behind);
  const auto states = publishedContacts(block.map, block.reel, path, options);
  for (std::size_t i = 0; i < path.size(); ++i) {
    ASSERT_EQ(states[i].contacts.size(), i + 1);
    EXPECT_TRUE(states[i].pierces);
    const Eigen::Vector3d cells = inCells(block.map, states[i].contacts.back());
    EXPECT_GT(cells.x(), 2.0);
    EXPECT_LE(cells.x(), 2.0 + options.sample_step + 1e-9);
  }
}

/// A box of 2 × 2 × 2 cells on the floor of a room.
VoxelMap boxOnTheFloor() {
  VoxelMap map = walks::emptyMap({7, 5, 7});
  for (int i = 0; i < 8; ++i) walks::occupy(map, {3 + i % 2, i / 2 % 2, 3 + i / 4});
  return map;
}

TEST(PublishedContacts, NearestEdgeIsAtTheHeightWhereTheLineEnters) {
  const VoxelMap map = boxOnTheFloor();
  const Eigen::Vector3d reel = at(map, {0.5, 1.0, 3.4});
  PublishedOptions options;
  options.sample_step = 0.001;
  // Through the side, next to the upright edge x = 3, z = 3.
  const Eigen::Vector3d behind(6.5, 1.6, 3.0);
  const auto beside = publishedContacts(map, reel, Points{at(map, behind)}, options);
  ASSERT_EQ(beside[0].contacts.size(), 1U);
  const Eigen::Vector3d contact = inCells(map, beside[0].contacts[0]);
  EXPECT_NEAR(contact.x(), 2.9, 1e-9);
  EXPECT_NEAR(contact.y(), 1.0 + 0.6 * 2.5 / 6.0, 1e-3);
  EXPECT_NEAR(contact.z(), 2.9, 1e-9);
  // Next to the top: the contact is over the upper edge, pushed out to both sides of it.
  const auto above =
      publishedContacts(map, at(map, {0.5, 1.9, 4.0}), Points{at(map, {6.5, 1.9, 4.0})}, options);
  expectPoints(above[0].contacts, {at(map, {2.9, 2.1, 4.0})});
}

/// Length of the shortest way over a point of the edges of a cell that both ends see, by trying
/// points all along the edges. Infinite if there is none. In cells.
double shortestWayOver(const VoxelMap& map, const Eigen::Vector3i& cell, const Eigen::Vector3d& a,
                       const Eigen::Vector3d& b) {
  constexpr int kParts = 400;
  const std::vector<std::uint8_t> blocked = obstacleCells(map, false);
  double shortest = std::numeric_limits<double>::infinity();
  for (int edge = 0; edge < 12; ++edge) {
    for (int i = 0; i <= kParts; ++i) {
      Eigen::Vector3d p;
      const int axis = edge / 4;
      p[axis] = static_cast<double>(i) / kParts;
      p[(axis + 1) % 3] = edge % 2;
      p[(axis + 2) % 3] = edge / 2 % 2;
      p += cell.cast<double>();
      const double length = (p - a).norm() + (b - p).norm();
      if (length < shortest && lineOfSight(map.shape, blocked, a, p) &&
          lineOfSight(map.shape, blocked, p, b))
        shortest = length;
    }
  }
  return shortest;
}

TEST(PublishedContacts, CornerIsTheShortestWayOverAnEdgeThatBothSee) {
  const Eigen::Vector3i cell(2, 2, 2);
  VoxelMap map = walks::emptyMap({5, 5, 5});
  walks::occupy(map, cell);
  walks::Random random(11);
  const auto any = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random() % 1000) / 1000.0;
  };
  int bent = 0;
  for (int n = 0; n < 600; ++n) {
    const Eigen::Vector3d reel(any(0.0, 1.9), any(0.0, 5.0), any(0.0, 5.0));
    const Eigen::Vector3d end(any(3.1, 5.0), any(0.0, 5.0), any(0.0, 5.0));
    const auto states = publishedContacts(map, at(map, reel), Points{at(map, end)}, kIdeal);
    const double possible = shortestWayOver(map, cell, reel, end);
    if (states[0].contacts.empty() || states[0].pierces) continue;
    const Eigen::Vector3d contact = inCells(map, states[0].contacts[0]);
    const double length = (contact - reel).norm() + (end - contact).norm();
    EXPECT_NEAR(length, possible, 1e-4) << n;
    ++bent;
  }
  EXPECT_GT(bent, 100);
}

// ---- errors -----------------------------------------------------------------------------------

TEST(PublishedContacts, RefusesWhatItCannotUse) {
  const Block block;
  const Points path{block.above};
  const auto key = [&](const Eigen::Vector3d& reel, const Points& points,
                       const PublishedOptions& options) {
    return problemOf([&] { (void)publishedContacts(block.map, reel, points, options); }).key;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(key(at(block.map, 2.5, 2.5), path, {}), "reel");
  EXPECT_EQ(key(at(block.map, {2.5, 7.0, 2.5}), path, {}),
            "reel");  // over it: in the plane, inside
  EXPECT_EQ(key({nan, 0.0, 0.0}, path, {}), "reel");
  EXPECT_EQ(key(block.reel, {block.above, {0.0, 0.0, nan}}, {}), "path[1]");
  EXPECT_EQ(key(block.reel, {{1e7, 0.0, 0.0}}, {}), "path[0]");
  EXPECT_EQ(key(block.reel, path, {.sample_step = 0.0}), "sample_step");
  EXPECT_EQ(key(block.reel, path, {.sample_step = nan}), "sample_step");
  EXPECT_EQ(key(block.reel, path, {.standoff = 0.6}), "standoff");
  EXPECT_TRUE(publishedContacts(block.map, block.reel, {}, {}).empty());
}

}  // namespace
}  // namespace tautline::planning
