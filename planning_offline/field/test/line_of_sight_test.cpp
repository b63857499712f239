// Exact voxel walks against an independent reference and exact clipping.

#include "planning_offline/field/line_of_sight.h"

#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/error.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/reference/field_reference.h"
#include "planning_offline/field/reference/synthetic_map.h"

namespace tautline::planning {
namespace {

using Units = Eigen::Vector3<std::int64_t>;

Eigen::Vector3i cellOf(const nlohmann::json& j) {
  // Planar cases have two axes: x and z here.
  if (j.size() == 2) return {j[0].get<int>(), 0, j[1].get<int>()};
  return {j[0].get<int>(), j[1].get<int>(), j[2].get<int>()};
}

TEST(LineOfSight, AgreesWithTheGoldenReachMaps) {
  std::ifstream file(TAUTLINE_SOURCE_DIR "/planning_offline/field/test/golden/raycast.json");
  const auto golden = nlohmann::json::parse(file);
  int checked = 0;
  for (const auto& c : golden["cases"]) {
    const auto& s = c["shape"];
    const GridShape shape = s.size() == 2
                                ? GridShape{s[0].get<int>(), 1, s[1].get<int>()}
                                : GridShape{s[0].get<int>(), s[1].get<int>(), s[2].get<int>()};
    std::vector<std::uint8_t> blocked(shape.size(), 0);
    for (const auto& o : c["occupied"]) {
      blocked[static_cast<std::size_t>(shape.index(cellOf(o)))] = 1;
    }
    const Eigen::Vector3d half(0.5, 0.5, 0.5);
    const Eigen::Vector3d anchor = cellOf(c["anchor_cell"]).cast<double>() + half;
    int reached = 0;
    int free = 0;
    for (const auto& cell : c["cells"]) {
      const Eigen::Vector3d target = cellOf(cell["cell"]).cast<double>() + half;
      const bool seen = lineOfSight(shape, blocked, anchor, target);
      EXPECT_EQ(seen, cell["state"] != "blocked") << c["id"] << " " << cell["cell"];
      ++free;
      reached += int{seen};
      ++checked;
    }
    EXPECT_NEAR(static_cast<double>(reached) / free, c["fraction_clear"].get<double>(), 1e-12);
  }
  EXPECT_GT(checked, 400);
}

/// Random pairs of points in units of 1 / `units` cell, up to `beyond` cells outside.
void compareWithClipping(std::int64_t units, int beyond, std::uint32_t seed, int pairs) {
  const GridShape shapes[] = {{6, 5, 7}, {9, 1, 9}, {12, 3, 2}};
  std::mt19937 random(seed);
  int seen = 0;
  for (const GridShape& shape : shapes) {
    const VoxelMap map = randomMap(shape, 0.12, 0.0, seed);
    const std::vector<std::uint8_t> blocked = obstacleCells(map, true);
    const auto point = [&](int n) {
      return std::uniform_int_distribution<std::int64_t>(-beyond * units,
                                                         (n + beyond) * units)(random);
    };
    for (int i = 0; i < pairs; ++i) {
      const Units a(point(shape.nx), point(shape.ny), point(shape.nz));
      const Units b(point(shape.nx), point(shape.ny), point(shape.nz));
      const auto cells = [units](const Units& p) {
        return Eigen::Vector3d(p.cast<double>() / static_cast<double>(units));
      };
      const bool expected = lineOfSightReference(shape, blocked, a, b, units);
      ASSERT_EQ(lineOfSight(shape, blocked, cells(a), cells(b)), expected)
          << cells(a).transpose() << " to " << cells(b).transpose();
      ASSERT_EQ(lineOfSight(shape, blocked, cells(b), cells(a)), expected);
      seen += int{expected};
    }
  }
  EXPECT_GT(seen, pairs / 20);
  EXPECT_LT(seen, 3 * pairs * 19 / 20);
}

TEST(LineOfSight, EqualsExactClippingBetweenCentresAndCorners) {
  for (std::uint32_t seed = 0; seed < 30; ++seed) compareWithClipping(2, 0, seed, 1000);
}

TEST(LineOfSight, EqualsExactClippingOutsideTheGrid) {
  for (std::uint32_t seed = 0; seed < 30; ++seed) compareWithClipping(2, 3, seed, 500);
}

TEST(LineOfSight, EqualsExactClippingBetweenAnyPoints) {
  for (std::uint32_t seed = 0; seed < 10; ++seed) compareWithClipping(65536, 1, seed, 1000);
  for (std::uint32_t seed = 0; seed < 10; ++seed) compareWithClipping(8, 1, seed, 1000);
}

TEST(LineOfSight, FarthestPointsDoNotOverflow) {
  const GridShape shape{3, 3, 3};
  std::vector<std::uint8_t> blocked(shape.size(), 0);
  blocked[static_cast<std::size_t>(shape.index({1, 1, 1}))] = 1;
  const Eigen::Vector3d far(16384.0, 16384.0, 16384.0);
  EXPECT_FALSE(lineOfSight(shape, blocked, -far, far));
  blocked[static_cast<std::size_t>(shape.index({1, 1, 1}))] = 0;
  blocked[static_cast<std::size_t>(shape.index({1, 1, 0}))] = 1;
  EXPECT_TRUE(lineOfSight(shape, blocked, -far, far));
}

/// A block of 2 × 2 × 2 cells from (2, 2, 2) to (4, 4, 4).
class Block : public ::testing::Test {
 protected:
  Block() {
    for (int z = 2; z < 4; ++z) {
      for (int y = 2; y < 4; ++y) {
        for (int x = 2; x < 4; ++x) blocked_[static_cast<std::size_t>(shape_.index({x, y, z}))] = 1;
      }
    }
  }
  [[nodiscard]] bool outside(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
    const bool there = outsideSolids(shape_, blocked_, a, b);
    EXPECT_EQ(outsideSolids(shape_, blocked_, b, a), there);
    return there;
  }
  GridShape shape_{6, 6, 6};
  std::vector<std::uint8_t> blocked_ = std::vector<std::uint8_t>(shape_.size(), 0);
};

TEST_F(Block, IsInTheWayOfLinesInItsGridPlanes) {
  EXPECT_FALSE(outside({0.5, 3, 2.5}, {5.5, 3, 3.5}));  // in one plane
  EXPECT_FALSE(outside({0.5, 3, 3}, {5.5, 3, 3}));      // in two
  EXPECT_FALSE(outside({3, 0.5, 3}, {3, 5.5, 3}));
  EXPECT_FALSE(outside({3, 3, -2}, {3, 3, 9}));
  EXPECT_FALSE(outside({3, 3, 3}, {3, 3, 3}));  // a point in three
  EXPECT_FALSE(outside({0.5, 2.5, 2.5}, {5.5, 3.5, 3.2}));
  EXPECT_TRUE(lineOfSight(shape_, blocked_, {0.5, 3, 3}, {5.5, 3, 3}));
}

TEST_F(Block, IsFreeAlongItsOuterFacesAndEdges) {
  EXPECT_TRUE(outside({0.5, 4, 2.5}, {5.5, 4, 3.5}));  // faces
  EXPECT_TRUE(outside({0.5, 2, 3}, {5.5, 2, 3}));
  EXPECT_TRUE(outside({2, 0.5, 3}, {2, 5.5, 3}));
  EXPECT_TRUE(outside({0.5, 4, 4}, {5.5, 4, 4}));  // edges
  EXPECT_TRUE(outside({2, 3, 3}, {2, 3, 3}));      // a point of a face
  EXPECT_TRUE(outside({0.5, 3, 1}, {5.5, 3, 1}));  // apart
}

TEST(OutsideSolids, IsLineOfSightWhereNoAxisStandsStill) {
  const GridShape shape{8, 8, 8};
  const VoxelMap map = randomMap(shape, 0.15, 0.0, 5);
  const std::vector<std::uint8_t> blocked = obstacleCells(map, true);
  std::mt19937 random(5);
  const auto point = [&random] {
    std::uniform_int_distribution<int> half(-2, 18);
    return Eigen::Vector3d(0.5 * half(random), 0.5 * half(random), 0.5 * half(random));
  };
  int seen = 0;
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d a = point();
    const Eigen::Vector3d b = point();
    if ((a.array() == b.array()).any()) continue;
    const bool expected = lineOfSight(shape, blocked, a, b);
    ASSERT_EQ(outsideSolids(shape, blocked, a, b), expected)
        << a.transpose() << " to " << b.transpose();
    seen += int{expected};
  }
  EXPECT_GT(seen, 500);
}

TEST(LineOfSight, MapsThatAreTooLongAreRefused) {
  VoxelMap map;
  map.shape = {16384, 1, 1};
  EXPECT_NO_THROW(needSightSize(map));
  map.shape = {16385, 1, 1};
  EXPECT_THROW(needSightSize(map), InputError);
}

}  // namespace
}  // namespace tautline::planning
