#include "planning_offline/map/lattice.h"

#include <bit>
#include <random>

#include <gtest/gtest.h>

namespace tautline::planning {
namespace {

std::vector<std::uint8_t> randomCells(const GridShape& shape, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution free(share);
  std::vector<std::uint8_t> cells(shape.size());
  for (std::uint8_t& cell : cells) cell = free(random) ? 1 : 0;
  return cells;
}

/// The definition: all cells that one gets to by any part of the step are on the map and free.
bool mayMove(const GridShape& shape, const std::vector<std::uint8_t>& free,
             const Eigen::Vector3i& from, const Eigen::Vector3i& step) {
  for (int parts = 0; parts < 8; ++parts) {
    const Eigen::Vector3i mask(parts & 1, (parts >> 1) & 1, (parts >> 2) & 1);
    const Eigen::Vector3i cell = from + step.cwiseProduct(mask);
    if (!shape.contains(cell) || free[static_cast<std::size_t>(shape.index(cell))] == 0)
      return false;
  }
  return true;
}

TEST(Direction, NumbersAllStepsAndTheirOpposites) {
  std::vector<int> seen(kDirections, 0);
  for (int z = -1; z <= 1; ++z) {
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) {
        const Eigen::Vector3i step(x, y, z);
        if (step.isZero()) continue;
        const Direction d = directionOf(step);
        ASSERT_TRUE(d >= 0 && d < kDirections);
        ++seen[static_cast<std::size_t>(d)];
        EXPECT_EQ(stepOf(d), step);
        EXPECT_EQ(stepOf(opposite(d)), Eigen::Vector3i(-step));
        EXPECT_DOUBLE_EQ(stepLength(d), step.cast<double>().norm());
      }
    }
  }
  EXPECT_EQ(seen, std::vector<int>(kDirections, 1));
}

TEST(Lattice, AnInnerFreeCellHasAllNeighbours) {
  for (const auto& [connectivity, plane, space] :
       {std::tuple{Connectivity::kFaces, 4, 6}, std::tuple{Connectivity::kEdges, 8, 18},
        std::tuple{Connectivity::kVertices, 8, 26}}) {
    const GridShape flat{3, 1, 3};
    const GridShape cube{3, 3, 3};
    const Lattice in_plane(flat, connectivity, std::vector<std::uint8_t>(flat.size(), 1));
    const Lattice in_space(cube, connectivity, std::vector<std::uint8_t>(cube.size(), 1));
    EXPECT_EQ(std::popcount(in_plane.moves(flat.index({1, 0, 1}))), plane);
    EXPECT_EQ(std::popcount(in_space.moves(cube.index({1, 1, 1}))), space);
    EXPECT_EQ(in_plane.directions().size(), static_cast<std::size_t>(plane));
    EXPECT_EQ(in_space.directions().size(), static_cast<std::size_t>(space));
  }
}

TEST(Lattice, MovesAreThoseOfTheDefinition) {
  std::size_t moves = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const GridShape shape =
        std::array{GridShape{5, 4, 3}, GridShape{6, 1, 5}, GridShape{1, 4, 3}}[seed % 3];
    const std::vector<std::uint8_t> free = randomCells(shape, 0.5 + 0.008 * seed, seed);
    for (const auto& [connectivity, axes_max] :
         {std::pair{Connectivity::kFaces, 1}, std::pair{Connectivity::kEdges, 2},
          std::pair{Connectivity::kVertices, 3}}) {
      const Lattice lattice(shape, connectivity, free);
      std::size_t free_count = 0;
      for (CellIndex i = 0; i < static_cast<CellIndex>(shape.size()); ++i) {
        EXPECT_EQ(lattice.free(i), free[static_cast<std::size_t>(i)] != 0);
        free_count += lattice.free(i) ? 1U : 0U;
        for (Direction d = 0; d < kDirections; ++d) {
          const Eigen::Vector3i& step = stepOf(d);
          const bool expected =
              step.cwiseAbs().sum() <= axes_max && mayMove(shape, free, shape.cell(i), step);
          ASSERT_EQ(((lattice.moves(i) >> d) & 1U) != 0, expected);
          if (!expected) continue;
          ++moves;
          EXPECT_EQ(shape.cell(lattice.neighbour(i, d)), shape.cell(i) + step);
          EXPECT_NE((lattice.moves(lattice.neighbour(i, d)) >> opposite(d)) & 1U, 0U);
        }
      }
      EXPECT_EQ(lattice.freeCount(), free_count);
    }
  }
  EXPECT_GT(moves, 10000U);
}

TEST(Lattice, NoCornerIsCut) {
  const GridShape shape{2, 1, 2};
  for (const std::size_t blocked : {1U, 2U}) {  // either of the two cells beside the diagonal
    std::vector<std::uint8_t> free(4, 1);
    free[blocked] = 0;
    const Lattice lattice(shape, Connectivity::kVertices, free);
    EXPECT_EQ((lattice.moves(0) >> directionOf({1, 0, 1})) & 1U, 0U);
  }
}

TEST(GridShape, IndexAndCellAreInverse) {
  const GridShape shape{3, 4, 5};
  for (CellIndex i = 0; i < static_cast<CellIndex>(shape.size()); ++i) {
    EXPECT_EQ(shape.index(shape.cell(i)), i);
  }
  EXPECT_EQ(shape.cell(1), Eigen::Vector3i(1, 0, 0));  // x fastest
  EXPECT_EQ(shape.cell(3), Eigen::Vector3i(0, 1, 0));
}

}  // namespace
}  // namespace tautline::planning
