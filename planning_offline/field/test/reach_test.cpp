// What a tether reaches, with the published set-up.

#include "planning_offline/field/reach.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "common/error.h"
#include "planning_offline/field/free_space.h"
#include "planning_offline/field/line_of_sight.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/reference/synthetic_map.h"

namespace tautline::planning {
namespace {

const Progress kQuiet;

void occupy(VoxelMap& map, const Eigen::Vector3i& cell) {
  map.cells[static_cast<std::size_t>(map.shape.index(cell))] = CellState::kOccupied;
}

/// Dissertation, chapter 5, "Tether Planning and Motion Execution": 10 × 10 × 10 voxels, a shaft of
/// one voxel at (4, 4) of the floor from bottom to top, the reel in the corner.
VoxelMap shaftRoom() {
  VoxelMap map = randomMap({10, 10, 10}, 0.0, 0.0, 1);
  for (int y = 0; y < 10; ++y) occupy(map, {4, y, 4});
  map.reel = Eigen::Vector3d(0.01, 0.01, 0.01);
  return map;
}

TEST(Reach, PublishedShaftRoom) {
  const VoxelMap map = shaftRoom();
  const auto free = freeSpace(map, {}, kQuiet);
  // The whole free space is counted; the tether keeps out of the shaft inflated by one voxel.
  const ReachMap reach = computeReach(map, free, *map.reel, {.tether_clearance = 1.0}, kQuiet);
  EXPECT_EQ(reach.free, 990U);
  EXPECT_EQ(reach.straight_count, 590U);
  EXPECT_EQ(std::lround(100.0 * 590.0 / 990.0), 60);
  EXPECT_EQ(reach.with_contacts_count, 990U);
  // Without the inflation the shaft would shade far less.
  EXPECT_EQ(computeReach(map, free, *map.reel, {}, kQuiet).straight_count, 840U);
}

TEST(Reach, StraightIsLineOfSightAndTheLimitsCountApart) {
  VoxelMap map = roomsMap({50, 12, 40}, 9);
  map.origin = Eigen::Vector3d(-2.0, 1.0, 0.5);
  const auto free = freeSpace(map, {.clearance = 0.12}, kQuiet);
  CellIndex start = 0;
  while (free[static_cast<std::size_t>(start)] == 0) ++start;
  const Eigen::Vector3d reel = map.centre(start) + Eigen::Vector3d(0.013, -0.02, 0.031);
  const ReachOptions options{.limits = {.length_max = 1.7, .elevation_min = 5.0}};
  const ReachMap reach = computeReach(map, free, reel, options, kQuiet);
  const std::vector<std::uint8_t> occupied = obstacleCells(map, false);
  std::size_t count = 0;
  std::size_t near = 0;
  std::size_t high = 0;
  std::size_t both = 0;
  for (CellIndex i = 0; i < static_cast<CellIndex>(free.size()); ++i) {
    const bool expected = free[static_cast<std::size_t>(i)] != 0 &&
                          lineOfSight(map.shape, occupied, (reel - map.origin) / map.resolution,
                                      (map.centre(i) - map.origin) / map.resolution);
    ASSERT_EQ(reach.straight[static_cast<std::size_t>(i)] != 0, expected) << i;
    if (!expected) continue;
    const Eigen::Vector3d way = map.centre(i) - reel;
    const bool is_near = way.norm() <= 1.7;
    const bool is_high = way.y() >= std::sin(5.0 * 3.14159265358979 / 180.0) * way.norm();
    ++count;
    near += is_near ? 1U : 0U;
    high += is_high ? 1U : 0U;
    both += is_near && is_high ? 1U : 0U;
  }
  EXPECT_EQ(reach.straight_count, count);
  EXPECT_EQ(reach.straight_within_length, near);
  EXPECT_EQ(reach.straight_within_elevation, high);
  EXPECT_EQ(reach.straight_within_limits, both);
  EXPECT_GT(both, 50U);
  EXPECT_LT(both, std::min(near, high));
  EXPECT_LT(std::max(near, high), count);
  EXPECT_EQ(reach.take_off, start);
  const ReachMap one_thread =
      computeReach(map, free, reel, {.limits = options.limits, .threads = 1}, kQuiet);
  EXPECT_EQ(one_thread.straight, reach.straight);
}

TEST(Reach, ContactsReachWhatIsConnectedOverFaces) {
  VoxelMap map = randomMap({9, 1, 9}, 0.0, 0.0, 1);
  for (int z = 0; z < 9; ++z) {
    if (z != 8) occupy(map, {3, 0, z});  // a wall with a gap at its end
    occupy(map, {6, 0, z});              // a closed one
  }
  const auto free = freeSpace(map, {}, kQuiet);
  const ReachMap reach = computeReach(map, free, {0.5, 0.5, 0.5}, {}, kQuiet);
  for (CellIndex i = 0; i < static_cast<CellIndex>(free.size()); ++i) {
    const bool expected = free[static_cast<std::size_t>(i)] != 0 && map.shape.cell(i).x() < 6;
    EXPECT_EQ(reach.with_contacts[static_cast<std::size_t>(i)] != 0, expected) << i;
  }
  EXPECT_LT(reach.straight_count, reach.with_contacts_count);
}

TEST(Reach, TakesOffNearAReelThatTheVehicleCannotBeAt) {
  // The reel stands on the floor, where the vehicle's clearance leaves no free cell.
  VoxelMap map = randomMap({9, 9, 9}, 0.0, 0.0, 1);
  map.solid_border = true;
  const auto free = freeSpace(map, {.clearance = 1.5}, kQuiet);
  const ReachMap reach = computeReach(map, free, {4.2, 0.0, 4.1}, {}, kQuiet);
  EXPECT_EQ(reach.free, 7U * 7U * 7U);
  EXPECT_EQ(reach.with_contacts_count, reach.free);
  EXPECT_EQ(reach.straight_count, reach.free);
}

TEST(Reach, RefusesAReelInsideAnObstacle) {
  const VoxelMap map = shaftRoom();
  const auto free = freeSpace(map, {}, kQuiet);
  EXPECT_THROW(static_cast<void>(computeReach(map, free, {4.5, 2.5, 4.5}, {}, kQuiet)), InputError);
  EXPECT_THROW(static_cast<void>(
                   computeReach(map, free, {3.5, 2.5, 4.5}, {.tether_clearance = 1.0}, kQuiet)),
               InputError);
  EXPECT_NO_THROW(static_cast<void>(computeReach(map, free, {4.0, 2.5, 4.5}, {}, kQuiet)));
}

TEST(Reach, RefusesAReelBetweenTheCellsOfAnObstacle) {
  VoxelMap map = randomMap({8, 8, 8}, 0.0, 0.0, 1);
  for (int z = 2; z < 4; ++z) {
    for (int y = 2; y < 4; ++y) {
      for (int x = 2; x < 4; ++x) occupy(map, {x, y, z});
    }
  }
  const auto free = freeSpace(map, {}, kQuiet);
  const auto reach = [&](const Eigen::Vector3d& reel, double clearance = 0.0) {
    return computeReach(map, free, reel, {.tether_clearance = clearance}, kQuiet);
  };
  const Eigen::Vector3d inside[] = {{3, 2.5, 2.5}, {3, 3, 2.5}, {3, 3, 3}};
  for (const Eigen::Vector3d& reel : inside) EXPECT_THROW((void)reach(reel), InputError);
  EXPECT_NO_THROW((void)reach({2, 3, 3}));                // on a face
  EXPECT_THROW((void)reach({2, 3, 3}, 1.0), InputError);  // between block and its clearance
  EXPECT_NO_THROW((void)reach({1, 2.5, 2.5}, 1.0));       // on the face of both
}

TEST(Reach, RefusesMapsThatAreTooLong) {
  VoxelMap map = randomMap({16385, 1, 1}, 0.0, 0.0, 1);
  const auto free = freeSpace(map, {}, kQuiet);
  EXPECT_THROW((void)computeReach(map, free, {0.5, 0.5, 0.5}, {}, kQuiet), InputError);
}

TEST(Reach, CancelledReachesNothingAndBlamesNobody) {
  const VoxelMap map = shaftRoom();
  const auto free = freeSpace(map, {}, kQuiet);
  Progress cancelled;
  cancelled.cancel();
  const ReachMap reach = computeReach(map, free, *map.reel, {.tether_clearance = 1.0}, cancelled);
  EXPECT_EQ(reach.straight_count, 0U);
  EXPECT_EQ(reach.with_contacts_count, 0U);
}

}  // namespace
}  // namespace tautline::planning
