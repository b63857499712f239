// Directions and steps of isovist lines, and the visibility field.

#include "planning_offline/field/isovist.h"

#include <cmath>

#include <gtest/gtest.h>

#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/reference/field_reference.h"
#include "planning_offline/field/reference/synthetic_map.h"
#include "planning_offline/simd.h"

namespace tautline::planning {
namespace {

const Progress kQuiet;

std::vector<float> visibility(const GridShape& shape, const std::vector<std::uint8_t>& obstacles,
                              const IsovistOptions& options) {
  return isovistField(shape, obstacles, options, kQuiet, {"visibility"});
}

TEST(IsovistDirections, AreUnitVectorsInOppositePairs) {
  for (const int count : {2, 7, 64, 98, 128}) {
    for (const bool planar : {false, true}) {
      const auto directions = isovistDirections(count, planar);
      ASSERT_EQ(static_cast<int>(directions.size()), count + count % 2);
      for (std::size_t i = 0; i < directions.size(); ++i) {
        EXPECT_NEAR(directions[i].norm(), 1.0, 1e-15);
        EXPECT_EQ(directions[i], -directions[i ^ 1U]);
        EXPECT_TRUE(!planar || directions[i].y() == 0.0);
      }
    }
  }
}

TEST(IsovistDirections, AreEvenOnTheSphere) {
  const auto directions = isovistDirections(kIsovistDirections, false);
  Eigen::Matrix3d second_moment = Eigen::Matrix3d::Zero();
  double nearest = 2.0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    second_moment += directions[i] * directions[i].transpose() / 98.0;
    for (std::size_t j = 0; j < i; ++j) {
      nearest = std::min(nearest, std::acos(directions[i].dot(directions[j])));
    }
  }
  EXPECT_LT((second_moment - Eigen::Matrix3d::Identity() / 3.0).cwiseAbs().maxCoeff(), 0.01);
  // 98 caps of equal area have a radius of 0.202 rad; the best packing known is 2 · 0.17 rad apart.
  EXPECT_GT(nearest, 0.2);
  double largest_hole = 0.0;
  for (const Eigen::Vector3d& probe : isovistDirections(20000, false)) {
    double angle = 4.0;
    for (const Eigen::Vector3d& d : directions) angle = std::min(angle, std::acos(probe.dot(d)));
    largest_hole = std::max(largest_hole, angle);
  }
  EXPECT_LT(largest_hole, 0.3);
}

TEST(RaySteps, EnterEachCellWhereItsFaceIs) {
  for (const Eigen::Vector3d& direction : isovistDirections(128, false)) {
    Eigen::Vector3i last = Eigen::Vector3i::Zero();
    double length = 0.0;
    for (const RayStep& step : raySteps(direction, 12.0)) {
      EXPECT_GT(step.length, length);
      EXPECT_LT(step.length, 12.0);
      length = step.length;
      EXPECT_EQ((step.offset - last).cwiseAbs().sum(), 1);
      // The point where it enters lies on the face between both cells.
      const Eigen::Vector3d entered = step.length * direction;
      const Eigen::Vector3d face = 0.5 * (step.offset + last).cast<double>();
      for (int k = 0; k < 3; ++k) {
        const double slack = step.offset[k] == last[k] ? 0.5 : 0.0;
        EXPECT_LE(std::abs(entered[k] - face[k]), slack + 1e-12);
      }
      last = step.offset;
    }
    EXPECT_GT(length, 10.0);
  }
}

TEST(RaySteps, ThroughACornerIntoTheDiagonalCellOnly) {
  const auto steps = raySteps(Eigen::Vector3d(1.0, 1.0, -1.0).normalized(), 2.0);
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_EQ(steps[0].offset, Eigen::Vector3i(1, 1, -1));
  EXPECT_NEAR(steps[0].length, std::sqrt(3.0) / 2.0, 1e-15);
}

TEST(Isovist, EqualsTheScalarWalkBitForBit) {
  const GridShape shapes[] = {{90, 5, 7}, {33, 1, 40}, {64, 9, 3}, {3, 20, 4}, {130, 2, 2}};
  for (const int bytes : {16, 32, 64}) {
    const SimdLimit limit(bytes);
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
      const VoxelMap map = randomMap(shapes[seed % 5], 0.02 * (seed % 4), 0.0, seed);
      const std::vector<std::uint8_t> obstacles = obstacleCells(map, true);
      const IsovistOptions options{.resolution = 0.2,
                                   .directions = seed % 2 == 0 ? 0 : 50,
                                   .cap = 0.05 + 2.0 * (seed % 3),
                                   .threads = 1 + static_cast<int>(seed % 3)};
      ASSERT_EQ(visibility(map.shape, obstacles, options),
                isovistReference(map.shape, obstacles, options))
          << bytes << " bytes, seed " << seed;
    }
  }
}

TEST(Isovist, ManyDirectionsDoNotOverflow) {
  const GridShape shape{9, 1, 9};
  const std::vector<std::uint8_t> free(shape.size(), 0);
  const auto v = visibility(shape, free, {.directions = 65536, .cap = 0.25});
  for (const float value : v) EXPECT_FLOAT_EQ(value, 0.25F);
}

TEST(Isovist, MiddleOfAnEmptyRoomByGeometry) {
  // The ray to the wall of a cube of side s is s / 2 over its largest component long.
  const GridShape shape{15, 15, 15};
  const std::vector<std::uint8_t> free(shape.size(), 0);
  const double cap = 100.0;
  const auto v = visibility(shape, free, {.resolution = 0.4, .cap = cap});
  double mean = 0.0;
  for (const Eigen::Vector3d& d : isovistDirections(98, false)) {
    mean += 0.4 * 7.5 / d.cwiseAbs().maxCoeff() / 98.0;
  }
  EXPECT_NEAR(v[static_cast<std::size_t>(shape.index({7, 7, 7}))], mean, cap / kIsovistUnits);
}

TEST(Isovist, ACapBeyondTheMapCostsNothing) {
  const VoxelMap map = randomMap({20, 7, 9}, 0.05, 0.0, 5);
  const std::vector<std::uint8_t> obstacles = obstacleCells(map, true);
  const IsovistOptions options{.directions = 1024, .cap = 1e6};
  EXPECT_EQ(visibility(map.shape, obstacles, options),
            isovistReference(map.shape, obstacles, options));
}

TEST(Isovist, IsTheSameInTheMapMirroredThroughItsMiddle) {
  const VoxelMap map = randomMap({40, 7, 9}, 0.05, 0.0, 5);
  const std::vector<std::uint8_t> obstacles = obstacleCells(map, true);
  std::vector<std::uint8_t> mirrored(obstacles.rbegin(), obstacles.rend());
  const auto v = visibility(map.shape, obstacles, {});
  auto m = visibility(map.shape, mirrored, {});
  std::reverse(m.begin(), m.end());
  EXPECT_EQ(v, m);
}

}  // namespace
}  // namespace tautline::planning
