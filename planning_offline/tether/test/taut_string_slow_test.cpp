// The strings on very many walks: how often the plane differs from its oracle (never), and how
// often no string is found in space.

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "planning_offline/tether/sliding_string.h"
#include "planning_offline/tether/taut_string.h"
#include "planning_offline/tether/test/prism.h"
#include "planning_offline/tether/test/rubber_band.h"
#include "planning_offline/tether/test/string_line.h"
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

/// How the contacts of a string among prisms differ from the oracle's; empty if they do not. Their
/// places along the edges are judged too if `along`.
std::string difference(const PrismWalk& walk, const std::vector<Eigen::Vector3d>& contacts,
                       const PrismString& wanted, bool along) {
  if (contacts.size() != wanted.contacts.size()) {
    return std::to_string(contacts.size()) + " contacts, not " +
           std::to_string(wanted.contacts.size());
  }
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    Eigen::Vector3d off = contacts[k] - wanted.contacts[k];
    if (!along) off[walk.axis] = 0.0;
    if (off.norm() > 0.01) {
      return "contact " + std::to_string(k) + " is " + std::to_string(off.norm()) + " m off";
    }
  }
  return {};
}

/// Contacts of the pinned string that bend it as seen along the prisms. One that is passed in line
/// there but was pinned at another height bends it along the edge only.
std::vector<Eigen::Vector3d> bendsInPlan(const PrismWalk& walk,
                                         const std::vector<Eigen::Vector3d>& contacts,
                                         const Eigen::Vector3d& reel, const Eigen::Vector3d& end) {
  std::vector<Eigen::Vector3d> flat = stringLine(reel, contacts, end);
  for (Eigen::Vector3d& p : flat) p[walk.axis] = 0.0;
  std::vector<Eigen::Vector3d> bends;
  Eigen::Vector3d last = flat.front();
  for (std::size_t k = 1; k + 1 < flat.size(); ++k) {
    if ((flat[k] - last).cross(flat[k + 1] - flat[k]).norm() < 1e-9) continue;
    bends.push_back(contacts[k - 1]);
    last = flat[k];
  }
  return bends;
}

// Both strings after every flight, and five times on the way. What differs is printed with its
// seed.
TEST(TautStringSlow, StringsAgreeWithTheShortestHomotopicPathOnAHundredThousandWalksAmongPrisms) {
  constexpr int kWalks = 100'000;
  int disagreeing = 0;
  std::int64_t contacts = 0;
  for (std::uint64_t seed = 1; seed <= kWalks; ++seed) {
    const PrismWalk walk = prismWalk(seed, 60);
    SlidingString sliding(walk.map, walk.points.front());
    const std::unique_ptr<TautString> pinned = makeTautString(walk.map, walk.points.front());
    StackId stack = kStraight;
    std::string what;
    for (std::size_t i = 1; i < walk.points.size() && what.empty(); ++i) {
      sliding.moveTo(walk.points[i]);
      stack = pinned->move(stack, walk.points[i - 1], walk.points[i]);
      if (i % 12 != 0) continue;
      const PrismString wanted = shortestAmongPrisms(walk, i);
      contacts += static_cast<std::int64_t>(wanted.contacts.size());
      what = difference(walk, sliding.contacts(), wanted, true);
      if (what.empty() && std::abs(sliding.length() - wanted.length) > 0.01)
        what = std::to_string(sliding.length()) + " m, not " + std::to_string(wanted.length);
      if (what.empty()) {
        what = difference(
            walk, bendsInPlan(walk, pinned->contacts(stack), walk.points.front(), walk.points[i]),
            wanted, false);
      }
      if (!what.empty()) what = "step " + std::to_string(i) + ": " + what;
    }
    if (what.empty()) continue;
    ++disagreeing;
    std::printf("seed %llu %s\n", static_cast<unsigned long long>(seed), what.c_str());
  }
  RecordProperty("disagreeing_walks", disagreeing);
  EXPECT_LE(disagreeing, kWalks / 1000);
  EXPECT_GT(contacts, 200'000);
}

// Without prisms: clutter and boxes.
TEST(TautStringSlow, EveryMoveOfTheFrictionlessStringIsResolved) {
  std::int64_t moves = 0;
  int failed_walks = 0;
  for (std::uint64_t seed = 1; seed <= 10'000; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::spaceMap(seed, random);
    const std::vector<Eigen::Vector3d> walk = walks::spaceWalk(map, 100, random);
    SlidingString string(map, walk.front());
    for (std::size_t i = 1; i < walk.size(); ++i) string.moveTo(walk[i]);
    moves += static_cast<std::int64_t>(walk.size()) - 1;
    if (string.unresolvedMoves() == 0) continue;
    ++failed_walks;
    std::printf("seed %llu: %lld moves unresolved\n", static_cast<unsigned long long>(seed),
                static_cast<long long>(string.unresolvedMoves()));
  }
  RecordProperty("failed_walks", failed_walks);
  EXPECT_GT(moves, 950'000);
  EXPECT_LE(failed_walks, 2);
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
    if (string->unresolvedMoves() == 0) continue;
    ++failed_walks;
    std::printf("seed %llu: %lld moves unresolved\n", static_cast<unsigned long long>(seed),
                static_cast<long long>(string->unresolvedMoves()));
  }
  RecordProperty("failed_walks", failed_walks);
  EXPECT_GT(moves, 5'900'000);
  EXPECT_LE(failed_walks, 5);
}

}  // namespace
}  // namespace tautline::planning
