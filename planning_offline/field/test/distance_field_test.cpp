// Distance to the surface of the nearest obstacle, and the free space made from it.

#include "planning_offline/field/distance_field.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "planning_offline/field/free_space.h"
#include "planning_offline/field/obstacles.h"
#include "planning_offline/field/reference/field_reference.h"
#include "planning_offline/field/reference/synthetic_map.h"
#include "planning_offline/simd.h"

namespace tautline::planning {
namespace {

const Progress kQuiet;

std::vector<float> distances(const GridShape& shape, const std::vector<std::uint8_t>& obstacles,
                             const DistanceOptions& options) {
  return distanceField(shape, obstacles, options, kQuiet, {"distance"});
}

/// With cells of one metre a distance d is the square root of an integer over two.
std::int64_t squaredHalfCells(float distance) {
  return std::llround(4.0 * static_cast<double>(distance) * static_cast<double>(distance));
}

GridShape randomShape(std::uint32_t seed) {
  const auto side = [&seed] {
    return static_cast<int>((seed = seed * 747796405U + 1U) >> 16) % 13;
  };
  return {1 + 2 * side(), 1 + side(), 1 + side()};
}

TEST(DistanceField, EqualsBruteForceInSquaredHalfCells) {
  for (const int bytes : {16, 32, 64}) {
    const SimdLimit limit(bytes);
    for (std::uint32_t seed = 0; seed < 120; ++seed) {
      const VoxelMap map = randomMap(randomShape(seed), 0.02 * (seed % 4), 0.0, seed);
      const std::vector<std::uint8_t> obstacles = obstacleCells(map, true);
      const bool solid = seed % 3 == 0;
      const auto expected = squaredDistanceReference(map.shape, obstacles, solid);
      const auto distance = distances(map.shape, obstacles, {.solid_border = solid});
      for (std::size_t i = 0; i < expected.size(); ++i) {
        if (expected[i] == kNothingNear) {
          const Eigen::Vector3d size(map.shape.nx, map.shape.ny, map.shape.nz);
          ASSERT_FLOAT_EQ(distance[i], static_cast<float>(size.norm()));
          continue;
        }
        ASSERT_EQ(squaredHalfCells(distance[i]), expected[i]) << "seed " << seed << " cell " << i;
        ASSERT_EQ(distance[i], 0.5F * std::sqrt(static_cast<float>(expected[i])));
      }
    }
  }
}

TEST(DistanceField, CappedIsExactBelowTheCapAndTheCapBeyond) {
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    const VoxelMap map = randomMap(randomShape(seed), 0.01, 0.0, seed);
    const std::vector<std::uint8_t> obstacles = obstacleCells(map, true);
    const bool nothing_near = std::count(obstacles.begin(), obstacles.end(), 1) == 0;
    const double cap = 0.5 * (1 + seed % 9);
    const auto all = distances(map.shape, obstacles, {.resolution = 0.3});
    const auto capped = distances(map.shape, obstacles, {.resolution = 0.3, .cap = cap});
    for (std::size_t i = 0; i < all.size(); ++i) {
      const float expected =
          nothing_near ? static_cast<float>(cap) : std::min(all[i], static_cast<float>(cap));
      ASSERT_EQ(capped[i], expected) << seed << " " << i;
    }
  }
}

TEST(DistanceField, FartherThanTheFastIntegersHold) {
  const GridShape shape{300, 2, 150};
  std::vector<std::uint8_t> obstacles(shape.size(), 0);
  obstacles[0] = 1;
  const auto distance = distances(shape, obstacles, {});
  const auto capped = distances(shape, obstacles, {.cap = 120.0});
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const Eigen::Array3d gap =
        (shape.cell(static_cast<CellIndex>(i)).cast<double>().array() - 0.5).max(0.0);
    ASSERT_FLOAT_EQ(distance[i], static_cast<float>(gap.matrix().norm())) << i;
    ASSERT_EQ(capped[i], std::min(distance[i], 120.0F));
  }
}

TEST(DistanceField, DoesNotDependOnThreads) {
  const VoxelMap map = roomsMap({60, 20, 50}, 3);
  const std::vector<std::uint8_t> obstacles = obstacleCells(map, true);
  EXPECT_EQ(distances(map.shape, obstacles, {.threads = 1}),
            distances(map.shape, obstacles, {.threads = 5}));
}

TEST(DistanceField, BorderBesideAPlanarMapOnly) {
  const GridShape shape{9, 1, 9};
  const std::vector<std::uint8_t> obstacles(shape.size(), 0);
  const auto distance = distances(shape, obstacles, {.solid_border = true});
  EXPECT_EQ(distance[static_cast<std::size_t>(shape.index({4, 0, 4}))], 4.5F);
  EXPECT_EQ(distance[static_cast<std::size_t>(shape.index({4, 0, 1}))], 1.5F);
}

TEST(FreeSpace, KeepsTheClearanceFromEveryObstacle) {
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    VoxelMap map = randomMap({14, 6, 11}, 0.02, 0.02, seed);
    map.resolution = 0.1;
    map.solid_border = seed % 2 == 0;
    const bool unknown_is_free = seed % 4 < 2;
    const double clearance = 0.03 * (seed % 7);
    const auto squared =
        squaredDistanceReference(map.shape, obstacleCells(map, !unknown_is_free), map.solid_border);
    const auto free =
        freeSpace(map, {.clearance = clearance, .unknown_is_free = unknown_is_free}, kQuiet);
    for (std::size_t i = 0; i < free.size(); ++i) {
      const bool obstacle = squared[i] == 0;
      const double distance =
          squared[i] == kNothingNear ? 1e9 : 0.05 * std::sqrt(static_cast<double>(squared[i]));
      ASSERT_EQ(free[i] != 0, !obstacle && distance > clearance - 1e-9) << seed << " " << i;
    }
  }
}

TEST(FreeSpace, APassageThatFitsExactlyStaysOpen) {
  for (const double resolution : {0.1, 0.3, 0.7, 1.0 / 3.0}) {
    VoxelMap map = randomMap({9, 1, 9}, 0.0, 0.0, 1);
    map.resolution = resolution;
    for (int z = 0; z < 9; ++z) {  // a corridor of three cells
      for (const int x : {2, 6}) {
        map.cells[static_cast<std::size_t>(map.shape.index({x, 0, z}))] = CellState::kOccupied;
      }
    }
    const auto middle = static_cast<std::size_t>(map.shape.index({4, 0, 4}));
    EXPECT_EQ(freeSpace(map, {.clearance = 1.5 * resolution}, kQuiet)[middle], 1);
    EXPECT_EQ(freeSpace(map, {.clearance = 1.501 * resolution}, kQuiet)[middle], 0);
  }
}

}  // namespace
}  // namespace tautline::planning
