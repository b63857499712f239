#include "planning_offline/tether/obstacle_confined.h"

#include <array>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "planning_offline/tether/test/published_kit.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

/// Points all over a triangle, a hundredth of its sides apart.
template <class Visit>
void visitTriangle(const std::array<Eigen::Vector3d, 3>& t, Visit visit) {
  constexpr int kParts = 100;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; i + j <= kParts; ++j) {
      const double u = static_cast<double>(i) / kParts;
      const double v = static_cast<double>(j) / kParts;
      visit(Eigen::Vector3d(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0])));
    }
  }
}

bool meetsCell(const std::array<Eigen::Vector3d, 3>& triangle, const Eigen::Vector3i& cell) {
  bool meets = false;
  visitTriangle(triangle, [&](const Eigen::Vector3d& p) {
    const Eigen::Array3d inside = (p - cell.cast<double>()).array();
    meets |= (inside > 1e-6).all() && (inside < 1.0 - 1e-6).all();
  });
  return meets;
}

TEST(ObstacleConfined, ThreeProjectionsSayYesWhereTheTrianglePassesTheCellBy) {
  VoxelMap map = walks::emptyMap({4, 4, 4});
  walks::occupy(map, {0, 0, 0});
  // The plane x + y + z = 4; the cell's farthest corner has 3.
  const std::array<Eigen::Vector3d, 3> triangle{{{4, 0, 0}, {0, 4, 0}, {0, 0, 4}}};
  EXPECT_TRUE(obstacleConfined(map, triangle[0], triangle[1], triangle[2]));
  EXPECT_FALSE(meetsCell(triangle, {0, 0, 0}));
  const Eigen::Vector3d normal =
      (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
  const double plane = normal.dot(triangle[0]);
  EXPECT_LT(normal.dot(Eigen::Vector3d::Ones()), plane - 0.5);  // the axis that is not tried
}

TEST(ObstacleConfined, IsNecessaryForTheTriangleToMeetTheCell) {
  walks::Random random(5);
  const auto coordinate = [&random] { return static_cast<double>(random() % 601) / 100.0; };
  const auto corner = [&] { return Eigen::Vector3d(coordinate(), coordinate(), coordinate()); };
  VoxelMap map = walks::emptyMap({6, 6, 6});
  const Eigen::Vector3i cell(2, 3, 2);
  walks::occupy(map, cell);
  int meeting = 0;
  int missed = 0;
  int apart = 0;
  for (int n = 0; n < 600; ++n) {
    const std::array<Eigen::Vector3d, 3> triangle{corner(), corner(), corner()};
    const bool confined = obstacleConfined(map, triangle[0], triangle[1], triangle[2]);
    EXPECT_EQ(confined, obstacleConfined(map, triangle[2], triangle[0], triangle[1]));
    const bool meets = meetsCell(triangle, cell);
    if (meets) {
      EXPECT_TRUE(confined) << n;
    }
    meeting += meets ? 1 : 0;
    missed += confined && !meets ? 1 : 0;
    apart += confined ? 0 : 1;
  }
  EXPECT_GT(meeting, 30);
  EXPECT_GT(missed, 10);
  EXPECT_GT(apart, 100);
}

TEST(ObstacleConfined, CellCentresAreNeverInsideALevelTriangle) {
  VoxelMap map = walks::emptyMap({6, 3, 6});
  walks::occupy(map, {2, 1, 2});
  const std::array<Eigen::Vector3d, 3> level{{{0.5, 1.5, 0.5}, {5.5, 1.5, 0.5}, {0.5, 1.5, 5.5}}};
  EXPECT_TRUE(obstacleConfined(map, level[0], level[1], level[2]));
  EXPECT_FALSE(obstacleConfined(map, level[0], level[1], level[2], Confinement::kCentreInside));
  // A layer higher nothing is touched; tilted enough, the centre is inside all three projections.
  const Eigen::Vector3d up(0.0, 1.0, 0.0);
  EXPECT_FALSE(obstacleConfined(map, level[0] + up, level[1] + up, level[2] + up));
  EXPECT_TRUE(obstacleConfined(map, {0.0, 0.0, 0.0}, {6.0, 1.2, 1.0}, {1.0, 3.0, 6.0},
                               Confinement::kCentreInside));
}

TEST(ObstacleConfined, TouchingFromOutsideIsNotConfined) {
  const VoxelMap map = drawnMap({"...", ".#.", "..."});
  const Eigen::Vector3d corner(1, 0.5, 1);
  EXPECT_FALSE(obstacleConfined(map, {0, 0.5, 2}, corner, {2, 0.5, 0}));
  EXPECT_FALSE(obstacleConfined(map, {0, 0.5, 1}, corner, {3, 0.5, 1}));
  EXPECT_TRUE(obstacleConfined(map, {0, 0.5, 2.02}, corner, {2.02, 0.5, 0}));
}

}  // namespace
}  // namespace tautline::planning
