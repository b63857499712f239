#include "app/experiments/map_world.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "app/experiments/cluttered_map.h"
#include "common/error.h"

namespace tautline::experiments {
namespace {

planning::VoxelMap noise(int nx, int ny, int nz, int percent, unsigned seed) {
  planning::VoxelMap map;
  map.name = "noise";
  map.shape = {nx, ny, nz};
  map.resolution = 0.4;
  map.origin = {-1.0, 0.5, 2.0};
  map.solid_border = true;
  std::mt19937 dice(seed);
  for (std::size_t i = 0; i < map.shape.size(); ++i)
    map.cells.push_back(static_cast<int>(dice() % 100) < percent ? planning::CellState::kOccupied
                                                                 : planning::CellState::kFree);
  return map;
}

bool inside(const Box& box, const Eigen::Vector3d& p) {
  return (p.array() > box.min.array()).all() && (p.array() < box.max.array()).all();
}

int boxesAt(const std::vector<Box>& boxes, const Eigen::Vector3d& p) {
  return static_cast<int>(
      std::count_if(boxes.begin(), boxes.end(), [&](const Box& b) { return inside(b, p); }));
}

/// By definition: no point nearer than `inflation` along any axis is in a cell that is not
/// occupied.
bool solidAt(const planning::VoxelMap& map, const Eigen::Vector3d& p, double inflation) {
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(inflation);
  const Eigen::Vector3i from = map.cellAt(p - reach);
  const Eigen::Vector3i to = map.cellAt(p + reach);
  for (int z = from.z(); z <= to.z(); ++z)
    for (int y = from.y(); y <= to.y(); ++y)
      for (int x = from.x(); x <= to.x(); ++x) {
        const Eigen::Vector3i c(x, y, z);
        if (map.shape.contains(c) && map.cells[static_cast<std::size_t>(map.shape.index(c))] !=
                                         planning::CellState::kOccupied)
          return false;
      }
  return true;
}

class BoxesOfVoxels : public ::testing::TestWithParam<double> {};

TEST_P(BoxesOfVoxels, FillWhatIsSolidOnceAndNothingElse) {
  for (const int percent : {5, 40, 85}) {
    const planning::VoxelMap map = noise(7, 5, 6, percent, 11U + static_cast<unsigned>(percent));
    const std::vector<Box> boxes = mergedBoxes(solidGrid(map, GetParam()));
    std::mt19937 dice(5);
    const auto chance = [&] { return static_cast<double>(dice()) / 4294967296.0; };
    for (int i = 0; i < 4000; ++i) {
      const Eigen::Vector3d p =
          map.origin + 0.4 * Eigen::Vector3d(7.0 * chance(), 5.0 * chance(), 6.0 * chance());
      ASSERT_EQ(boxesAt(boxes, p), solidAt(map, p, GetParam()) ? 1 : 0) << p.transpose();
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Inflation, BoxesOfVoxels, ::testing::Values(0.0, 0.15, 0.19));

TEST(BoxesOfVoxels, AreMerged) {
  planning::VoxelMap map = noise(6, 4, 5, 0, 1);
  EXPECT_TRUE(mergedBoxes(solidGrid(map, 0.0)).empty());
  std::fill(map.cells.begin(), map.cells.end(), planning::CellState::kOccupied);
  const std::vector<Box> boxes = mergedBoxes(solidGrid(map, 0.15));
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_TRUE(boxes[0].min.isApprox(map.origin));
  EXPECT_TRUE(boxes[0].max.isApprox(map.origin + Eigen::Vector3d(2.4, 1.6, 2.0)));
}

MissionPlan& missionTo(const Eigen::Vector3d& p_WD) {
  static MissionPlan plan;
  plan.waypoint_count = 1;
  plan.waypoints[0].p_WD = p_WD;
  return plan;
}

TEST(WorldOfMap, ParksTheDroneOnWhatIsBelowTheFirstWaypoint) {
  planning::VoxelMap map = clutteredMap(0, 1);
  const MissionPlan& mission = missionTo(*map.start - *map.reel);
  const Scene empty = worldOf(map, *map.reel, mission, 0.15);
  ASSERT_TRUE(empty.start.has_value());
  EXPECT_NEAR(empty.start->x(), map.start->x() - map.reel->x(), 1e-12);
  EXPECT_NEAR(empty.start->y(), kFoot - 0.15 - map.reel->y(), 1e-12);
  EXPECT_NEAR(empty.floor, -0.15 - map.reel->y(), 1e-12);
  // A block of a cell under it, and one above.
  Eigen::Vector3i cell = map.cellAt(*map.start);
  for (const int y : {0, 7}) {
    cell.y() = y;
    map.cells[static_cast<std::size_t>(map.shape.index(cell))] = planning::CellState::kOccupied;
  }
  const Scene block = worldOf(map, *map.reel, mission, 0.0);
  EXPECT_NEAR(block.start->y(), 0.4 + kFoot - map.reel->y(), 1e-12);
}

TEST(WorldOfMap, WallsAreAsFarBehindTheBorderAsThingsAreInsideTheirVoxels) {
  planning::VoxelMap map = noise(6, 4, 5, 0, 1);
  const Eigen::Vector3i corner(0, 0, 4);  // against three walls
  map.cells[static_cast<std::size_t>(map.shape.index(corner))] = planning::CellState::kOccupied;
  const MissionPlan& mission = missionTo({1.0, 0.5, 0.5});
  const Scene world = worldOf(map, map.origin, mission, 0.15);
  const Eigen::Vector3d size(2.4, 1.6, 2.0);
  EXPECT_TRUE(world.min.isApprox(Eigen::Vector3d::Constant(-0.15)));
  EXPECT_TRUE(world.max.isApprox(size + Eigen::Vector3d::Constant(0.15)));
  EXPECT_NEAR(world.floor, -0.15, 1e-12);
  ASSERT_EQ(world.boxes.size(), 1U);
  EXPECT_TRUE(world.boxes[0].min.isApprox(Eigen::Vector3d(-0.15, -0.15, 1.75)));
  EXPECT_TRUE(world.boxes[0].max.isApprox(Eigen::Vector3d(0.25, 0.25, 2.15)));
  map.solid_border = false;
  const Scene open = worldOf(map, map.origin, mission, 0.15);
  EXPECT_NEAR(open.floor, -0.15, 1e-12);
  EXPECT_NEAR(open.min.y(), -0.15, 1e-12);
  EXPECT_LT(open.min.x(), -90.0);
  EXPECT_GT(open.max.y(), 90.0);
}

TEST(WorldOfMap, RefusesMoreThanThePlantTakes) {
  const planning::VoxelMap map = noise(20, 10, 20, 30, 3);
  try {
    (void)worldOf(map, map.origin, missionTo({0.0, 0.5, 0.5}), 0.0);
    FAIL() << "not refused";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("at most 512"), std::string::npos) << e.what();
  }
}

TEST(WorldOfMap, TextReadsBack) {
  const planning::VoxelMap map = clutteredMap(8, 2);
  const Scene world = worldOf(map, *map.reel, missionTo(*map.start - *map.reel), 0.15);
  const Scene back = sceneInWorld(parseScene(sceneText(sceneFromWorld(world, *map.reel)), "text"));
  ASSERT_EQ(back.boxes.size(), world.boxes.size());
  for (std::size_t i = 0; i < back.boxes.size(); ++i) {
    EXPECT_TRUE(back.boxes[i].min.isApprox(world.boxes[i].min, 1e-12));
    EXPECT_TRUE(back.boxes[i].max.isApprox(world.boxes[i].max, 1e-12));
  }
  EXPECT_TRUE(back.start->isApprox(*world.start, 1e-12));
}

TEST(ClutteredMap, IsTheSameForASeedAndLeavesRoomToStart) {
  const planning::VoxelMap a = clutteredMap(32, 7);
  const planning::VoxelMap b = clutteredMap(32, 7);
  EXPECT_TRUE(a.cells == b.cells);
  EXPECT_FALSE(a.cells == clutteredMap(32, 8).cells);
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    if (a.cells[i] != planning::CellState::kOccupied) continue;
    const double from_centre = (a.centre(static_cast<planning::CellIndex>(i)) - *a.start).norm();
    EXPECT_GT(from_centre, 0.9);
  }
}

TEST(ClutteredMap, GoalsAreReachableAndFar) {
  const planning::RiskSpace space = riskSpaceOf(clutteredMap(20, 3), {});
  const std::vector<Eigen::Vector3d> goals = goalsIn(space, 5, 2.0, 1);
  ASSERT_EQ(goals.size(), 5U);
  for (const Eigen::Vector3d& goal : goals) {
    EXPECT_GE(
        (goal - space.space.map->centre(space.space.map->indexAt(*space.space.map->start))).norm(),
        2.0);
    EXPECT_TRUE(space.space.lattice->free(space.space.map->indexAt(goal)));
  }
}

}  // namespace
}  // namespace tautline::experiments
