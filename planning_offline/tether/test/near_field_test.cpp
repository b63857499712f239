// Where a string is said to be far from edges and cells, against the distance from every one.

#include "planning_offline/tether/near_field.h"

#include <cmath>

#include <gtest/gtest.h>

#include "planning_offline/tether/shrunk_solid.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

/// An edge or a cell.
struct Feature {
  Eigen::Vector3d low;
  Eigen::Vector3d high;

  /// In the maximum norm.
  [[nodiscard]] double distance(const Eigen::Vector3d& p) const {
    return (low - p).cwiseMax(p - high).cwiseMax(0.0).maxCoeff();
  }
};

double nearest(const std::vector<Feature>& features, const Eigen::Vector3d& p) {
  double least = 1e9;
  for (const Feature& feature : features) least = std::min(least, feature.distance(p));
  return least;
}

std::vector<Feature> edgesOf(const VoxelMap& map) {
  std::vector<Feature> out;
  for (int axis = 0; axis < 3; ++axis) {
    const ConvexEdges edges(map, axis);
    for (int w = 0; w < edges.sizeW(); ++w) {
      for (int v = 0; v <= edges.sizeV(); ++v) {
        for (int u = 0; u <= edges.sizeU(); ++u) {
          if (edges.quadrants(u, v, w) == 0) continue;
          Feature edge;
          edge.low[axisU(axis)] = u;
          edge.low[axisV(axis)] = v;
          edge.low[axis] = w;
          edge.high = edge.low;
          edge.high[axis] += 1.0;
          out.push_back(edge);
        }
      }
    }
  }
  return out;
}

std::vector<Feature> occupiedOf(const VoxelMap& map) {
  std::vector<Feature> out;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (map.cells[i] != CellState::kOccupied) continue;
    const Eigen::Vector3d low = map.shape.cell(static_cast<CellIndex>(i)).cast<double>();
    out.push_back({low, low.array() + 1.0});
  }
  return out;
}

/// Anywhere on a map and up to two cells outside; every third coordinate on the grid.
Eigen::Vector3d anyPoint(const GridShape& shape, walks::Random& random) {
  const Eigen::Vector3d size(shape.nx, shape.ny, shape.nz);
  Eigen::Vector3d p;
  for (int axis = 0; axis < 3; ++axis) {
    p[axis] = std::uniform_real_distribution<double>(-2.0, size[axis] + 2.0)(random);
    if (random() % 3 == 0) p[axis] = std::round(p[axis]);
  }
  return p;
}

bool covered(const Stretches& stretches, double t) {
  for (const auto& [low, high] : stretches) {
    if (low <= t && t <= high) return true;
  }
  return false;
}

TEST(NearField, IsNeverFartherThanTheNearestFeature) {
  walks::Random random(3);
  double sum = 0.0;
  double bound = 0.0;
  for (const int one_in : {8, 60, 400}) {
    const VoxelMap map = walks::clutteredMap({12, 9, 14}, one_in, random);
    const ShrunkSolid solid(map);
    const std::vector<Feature> edges = edgesOf(map);
    const std::vector<Feature> occupied = occupiedOf(map);
    for (int n = 0; n < 2000; ++n) {
      const Eigen::Vector3d p = anyPoint(map.shape, random);
      const NearField::Distance d = solid.field().distance(p);
      ASSERT_LE(d.edges, nearest(edges, p)) << p.transpose();
      ASSERT_LE(d.occupied, nearest(occupied, p)) << p.transpose();
      ASSERT_LE(d.occupied, d.edges);
      sum += nearest(occupied, p);
      bound += d.occupied;
    }
  }
  EXPECT_GT(bound, 0.4 * sum);  // and not much less
}

TEST(NearField, CallsNoPartOfAStringFarThatIsNear) {
  walks::Random random(4);
  int far = 0;
  int near = 0;
  for (int n = 0; n < 1500; ++n) {
    const VoxelMap map = walks::boxesMap({14, 10, 12}, 3, 4, random);
    const ShrunkSolid solid(map);
    const std::vector<Feature> edges = edgesOf(map);
    const std::vector<Feature> occupied = occupiedOf(map);
    const Eigen::Vector3d c = anyPoint(map.shape, random);
    const Eigen::Vector3d p = anyPoint(map.shape, random);
    const Eigen::Vector3d step = (anyPoint(map.shape, random) - p) / (n % 3 == 0 ? 3.0 : 12.0);
    const Eigen::Vector3d q = n % 4 == 0 ? p : Eigen::Vector3d(p + step);
    const NearField::Near found = solid.field().near(c, p, q);
    for (double t = 0.0; t <= 1.0; t += 1.0 / 64) {
      for (const double side : {0.0, 0.3, 1.0}) {
        const Eigen::Vector3d x = c + t * (p + side * (q - p) - c);
        if (!covered(found.edges, t)) {
          ASSERT_GT(nearest(edges, x), 0.99 * NearField::kMargin);
          ++far;
        }
        if (!covered(found.occupied, t)) {
          ASSERT_GT(nearest(occupied, x), 0.99 * NearField::kMargin);
          ++far;
        } else {
          ++near;
        }
      }
    }
  }
  EXPECT_GT(far, near);
  EXPECT_GT(near, 1000);
}

TEST(NearField, AnEmptyMapIsFarFromEverything) {
  const ShrunkSolid solid(walks::emptyMap({300, 2, 300}));
  EXPECT_EQ(solid.field().distance({10.0, 1.0, 10.0}).edges, NearField::kFarthest);
  EXPECT_TRUE(solid.field()
                  .near({0.5, 0.5, 0.5}, {299.0, 1.5, 280.0}, {299.5, 1.0, 281.0})
                  .occupied.empty());
}

TEST(NearField, AStringOfNoLengthIsNearEverything) {
  const ShrunkSolid solid(walks::emptyMap({5, 5, 5}));
  const Eigen::Vector3d c(2.5, 2.5, 2.5);
  EXPECT_TRUE(covered(solid.field().near(c, c, c).edges, 0.5));
}

TEST(Stretches, RunFromTheEndToTheAnchorAndJoin) {
  Stretches stretches;
  EXPECT_TRUE(stretches.empty());
  for (int k = 0; k < 10; ++k) stretches.add(0.9 - 0.09 * k, 0.93 - 0.09 * k);
  stretches.add(0.05, 0.09);
  EXPECT_EQ(stretches.end() - stretches.begin(), 8);
  double before = 1.0;
  for (const auto& [low, high] : stretches) {
    EXPECT_LT(low, high);
    EXPECT_LT(high, before);
    before = low;
  }
  EXPECT_EQ(before, 0.05);
  for (const double t : {0.91, 0.1, 0.07}) EXPECT_TRUE(covered(stretches, t)) << t;
  EXPECT_FALSE(covered(stretches, 0.95));
}

}  // namespace
}  // namespace tautline::planning
