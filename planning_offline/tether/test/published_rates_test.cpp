/// @file
/// How often the dissertation's contact planner and the taut string agree on random walks in the
/// plane, against what an independent implementation of both found.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "planning_offline/field/line_of_sight.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/tether/compare_contacts.h"
#include "planning_offline/tether/test/published_kit.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

/// A plan with random pillars of one or two cells a side.
VoxelMap pillars(walks::Random& random) {
  constexpr std::uint64_t kSide = 16;
  VoxelMap map = walks::emptyMap({kSide, 1, kSide});
  for (int n = 0; n < 14; ++n) {
    const int x = static_cast<int>(1 + random() % (kSide - 2));
    const int z = static_cast<int>(1 + random() % (kSide - 2));
    const int side = static_cast<int>(1 + random() % 2);
    for (int i = 0; i < side * side; ++i) walks::occupy(map, {x + i % side, 0, z + i / side});
  }
  return map;
}

/// Every third point where the straight way there is free, else the farthest before it.
Points strided(const VoxelMap& map, const Points& path) {
  const std::vector<std::uint8_t> blocked = obstacleCells(map, false);
  Points strided{path.front()};
  for (std::size_t i = 0; i + 1 < path.size();) {
    std::size_t next = std::min(i + 3, path.size() - 1);
    while (next > i + 1 &&
           !lineOfSight(map.shape, blocked, inCells(map, path[i]), inCells(map, path[next])))
      --next;
    strided.push_back(path[next]);
    i = next;
  }
  return strided;
}

struct Rates {
  double contacts{0.0};   ///< Mean number of the taut string's.
  double waypoints{0.0};  ///< Share with the taut string's contacts.
  double paths{0.0};      ///< Share with the taut string's contacts everywhere.
  double pierced{0.0};    ///< Share of waypoints with the tether in an obstacle.
  double worst{0.0};      ///< Largest difference of lengths [cells].
};

/// Over 300 random walks from the reel, each in a map of its own.
Rates rates(bool clutter, bool stride, ContactPlacement placement) {
  PublishedOptions options = kIdeal;
  options.placement = placement;
  Rates sum;
  double rows = 0.0;
  double paths = 0.0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = clutter ? walks::clutteredMap({20, 1, 20}, 6, random) : pillars(random);
    const Lattice lattice =
        walks::freeLattice(map, clutter ? Connectivity::kVertices : Connectivity::kFaces);
    Points path = walks::centres(map, walks::randomWalk(lattice, clutter ? 44 : 34, random));
    const Eigen::Vector3d reel = path.front();
    if (stride) path = strided(map, path);
    bool all = true;
    for (const ContactRow& row : compareContacts(map, reel, path, options).rows) {
      const Points& contacts = row.published.contacts;
      const bool same = std::equal(
          contacts.begin(), contacts.end(), row.exact.contacts.begin(), row.exact.contacts.end(),
          [](const auto& a, const auto& b) { return (a - b).norm() < 1e-6; });
      all = all && same;
      rows += 1.0;
      sum.contacts += static_cast<double>(row.exact.contacts.size());
      sum.waypoints += same ? 1.0 : 0.0;
      sum.pierced += row.published.pierces ? 1.0 : 0.0;
      sum.worst =
          std::max(sum.worst, std::abs(row.published.length - row.exact.length) / map.resolution);
    }
    paths += 1.0;
    sum.paths += all ? 1.0 : 0.0;
  }
  return {sum.contacts / rows, sum.waypoints / rows, sum.paths / paths, sum.pierced / rows,
          sum.worst};
}

/// An independent implementation found these shares of waypoints and paths with the taut string's
/// contacts on 300 random paths in scenes of the same kind; its maps and walks are not ours.
struct ReferenceRates {
  const char* scene;
  bool clutter;
  bool stride;
  double contacts;
  std::array<double, 2> entry;  ///< Waypoints, paths.
  std::array<double, 2> corner;
};

TEST(PublishedContacts, AgreesWithTheTautStringAsOftenAsTheReferenceFound) {
  constexpr double kWaypointBand = 0.1;
  constexpr double kPathBand = 0.12;
  for (const ReferenceRates& reference :
       {ReferenceRates{"pillars", false, false, 0.84, {0.54, 0.25}, {0.95, 0.86}},
        ReferenceRates{"clutter", true, false, 1.18, {0.39, 0.08}, {0.90, 0.72}},
        ReferenceRates{"pillars_stride_3", false, true, 0.64, {0.61, 0.30}, {0.75, 0.51}},
        ReferenceRates{"clutter_stride_3", true, true, 1.11, {0.45, 0.14}, {0.61, 0.31}}}) {
    const Rates corner = rates(reference.clutter, reference.stride, ContactPlacement::kCorner);
    const Rates entry = rates(reference.clutter, reference.stride, ContactPlacement::kEntry);
    const Rates nearest =
        rates(reference.clutter, reference.stride, ContactPlacement::kNearestEdge);
    for (const auto& [name, found] :
         {std::pair{"corner", corner}, std::pair{"entry", entry}, std::pair{"nearest", nearest}}) {
      const std::string key = std::string(reference.scene) + "_" + name;
      ::testing::Test::RecordProperty(key + "_mean_contacts", std::to_string(found.contacts));
      ::testing::Test::RecordProperty(key + "_waypoints", std::to_string(found.waypoints));
      ::testing::Test::RecordProperty(key + "_paths", std::to_string(found.paths));
      ::testing::Test::RecordProperty(key + "_pierced", std::to_string(found.pierced));
      ::testing::Test::RecordProperty(key + "_worst_cells", std::to_string(found.worst));
    }
    SCOPED_TRACE(reference.scene);
    EXPECT_NEAR(corner.contacts, reference.contacts, 0.15);
    EXPECT_NEAR(corner.waypoints, reference.corner[0], kWaypointBand);
    EXPECT_NEAR(corner.paths, reference.corner[1], kPathBand);
    EXPECT_NEAR(entry.waypoints, reference.entry[0], kWaypointBand);
    EXPECT_NEAR(entry.paths, reference.entry[1], kPathBand);
    EXPECT_GE(corner.pierced, 0.003);
    EXPECT_LE(corner.pierced, 0.14);
    EXPECT_GE(entry.pierced, 0.29);
    EXPECT_GT(corner.worst, 5.0);  // a wrong homotopy class
    // The authors' own placement is between the two.
    EXPECT_GT(nearest.waypoints, entry.waypoints);
    EXPECT_LT(nearest.waypoints, corner.waypoints);
  }
}

}  // namespace
}  // namespace tautline::planning
