// The strings on very many walks: how often the plane differs from its oracle (never), and how
// often no string is found in space.

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "planning_offline/tether/taut_string.h"
#include "planning_offline/tether/test/rubber_band.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

TEST(TautStringSlow, PlanarLengthEqualsTheTightenedPathOnAHundredThousandWalks) {
  int walks_checked = 0;
  for (std::uint64_t seed = 1; seed <= 100'000; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::clutteredMap({9, 1, 10}, 4 + static_cast<int>(seed % 7), random);
    const std::vector<Eigen::Vector3d> walk = walks::centres(
        map, walks::randomWalk(walks::freeLattice(map, Connectivity::kVertices), 60, random));
    if (walk.empty()) continue;
    const std::unique_ptr<TautString> string = makeTautString(map, walk.front());
    StackId stack = kStraight;
    std::vector<BandPoint> path;
    for (std::size_t i = 0; i < walk.size(); ++i) {
      if (i > 0) stack = string->move(stack, walk[i - 1], walk[i]);
      const Eigen::Vector3d cells = (walk[i] - map.origin) / map.resolution;
      path.push_back({std::llround(1024.0 * cells.z()), std::llround(1024.0 * cells.x())});
    }
    const std::vector<BandPoint> band = tightened(map, path);
    double length = 0.0;
    for (std::size_t i = 1; i < band.size(); ++i) {
      length += std::hypot(static_cast<double>(band[i].u - band[i - 1].u),
                           static_cast<double>(band[i].v - band[i - 1].v));
    }
    ASSERT_NEAR(string->length(stack, walk.back()), length * map.resolution / 1024.0, 1e-9)
        << "seed " << seed;
    ++walks_checked;
  }
  EXPECT_GT(walks_checked, 99'000);
}

TEST(TautStringSlow, SpatialMovesAreResolvedButForOneInAMillion) {
  std::int64_t moves = 0;
  int failed_walks = 0;
  for (std::uint64_t seed = 1; seed <= 50'000; ++seed) {
    walks::Random random(seed);
    const VoxelMap map =
        seed % 2 == 0 ? walks::clutteredMap({8, 8, 8}, 4 + static_cast<int>(seed % 9), random)
                      : walks::boxesMap({8, 8, 8}, 14, 4, random);
    const std::vector<Eigen::Vector3d> walk = walks::centres(
        map, walks::randomWalk(walks::freeLattice(map, Connectivity::kVertices), 120, random));
    const std::unique_ptr<TautString> string = makeTautString(map, walk.front());
    StackId stack = kStraight;
    for (std::size_t i = 1; i < walk.size() && string->unresolvedMoves() == 0; ++i) {
      stack = string->move(stack, walk[i - 1], walk[i]);
      ++moves;
    }
    failed_walks += string->unresolvedMoves() > 0 ? 1 : 0;
  }
  RecordProperty("failed_walks", failed_walks);
  EXPECT_GT(moves, 5'900'000);
  EXPECT_LE(failed_walks, 5);
}

}  // namespace
}  // namespace tautline::planning
