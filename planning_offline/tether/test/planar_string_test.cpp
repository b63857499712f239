#include "planning_offline/tether/planar_string.h"

#include <cmath>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "planning_offline/tether/test/rubber_band.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

constexpr double kFine = 1024.0;

BandPoint bandPoint(const VoxelMap& map, const Eigen::Vector3d& p) {
  const Eigen::Vector3d cells = (p - map.origin) / map.resolution;
  return {std::llround(cells.z() * kFine), std::llround(cells.x() * kFine)};
}

Eigen::Vector3d pointOf(const VoxelMap& map, const BandPoint& b) {
  const double unit = map.resolution / kFine;
  return map.origin + Eigen::Vector3d(static_cast<double>(b.v) * unit, 0.5 * map.resolution,
                                      static_cast<double>(b.u) * unit);
}

/// The string's contacts against the tight band of the path flown.
void expectTight(const VoxelMap& map, const TautString& string, StackId stack,
                 const std::vector<BandPoint>& path, const std::string& what) {
  const std::vector<BandPoint> band = tightened(map, path);
  const std::vector<Eigen::Vector3d> contacts = string.contacts(stack);
  ASSERT_EQ(contacts.size() + (band.size() > 1 ? 2 : 1), band.size()) << what;
  double length = 0.0;
  for (std::size_t i = 1; i < band.size(); ++i) {
    length += (pointOf(map, band[i]) - pointOf(map, band[i - 1])).norm();
    if (i + 1 < band.size()) {
      ASSERT_TRUE(contacts[i - 1].isApprox(pointOf(map, band[i]), 1e-12)) << what;
    }
  }
  ASSERT_NEAR(string.length(stack, pointOf(map, path.back())), length, 1e-9) << what;
  ASSERT_EQ(string.contactCount(stack), static_cast<int>(contacts.size()));
}

TEST(PlanarString, EqualsTheGoldenContacts) {
  std::ifstream in(TAUTLINE_SOURCE_DIR "/planning_offline/tether/test/golden/contact_2d.json");
  const nlohmann::json golden = nlohmann::json::parse(in);
  int points = 0;
  for (const auto& scene : golden.at("cases")) {
    VoxelMap map = walks::emptyMap({scene.at("ny"), 1, scene.at("nx")});  // axes 0, 1 are z, x
    for (const auto& cell : scene.at("occupied")) walks::occupy(map, {cell[1], 0, cell[0]});
    const auto centre = [&map](const nlohmann::json& cell) {
      return map.centre(map.shape.index({cell[1], 0, cell[0]}));
    };
    Eigen::Vector3d at = centre(scene.at("path")[0]);
    PlanarString string(map, at);
    StackId stack = kStraight;
    for (const auto& waypoint : scene.at("waypoints")) {
      const Eigen::Vector3d to = centre(waypoint.at("cell"));
      stack = string.move(stack, at, to);
      at = to;
      const std::vector<Eigen::Vector3d> contacts = string.contacts(stack);
      const auto& wanted = waypoint.at("contacts");
      ASSERT_EQ(contacts.size(), wanted.size()) << scene.at("id");
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Eigen::Vector3d cells = (contacts[i] - map.origin) / map.resolution;
        EXPECT_NEAR(cells.z(), wanted[i][0].get<double>(), 1e-9) << scene.at("id");
        EXPECT_NEAR(cells.x(), wanted[i][1].get<double>(), 1e-9) << scene.at("id");
        EXPECT_DOUBLE_EQ(cells.y(), 0.5);
      }
      EXPECT_NEAR(string.length(stack, at) / map.resolution, waypoint.at("length").get<double>(),
                  1e-9)
          << scene.at("id");
      ++points;
    }
  }
  EXPECT_EQ(points, 213);
}

TEST(PlanarString, EqualsTheTightenedPathOnRandomWalksOverCells) {
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    walks::Random random(seed);
    const GridShape shape{6 + static_cast<int>(seed % 7), 1, 6 + static_cast<int>(seed / 7 % 7)};
    const VoxelMap map = seed % 3 == 0
                             ? walks::boxesMap(shape, 6, 3, random)
                             : walks::clutteredMap(shape, 4 + static_cast<int>(seed % 8), random);
    const Lattice lattice =
        walks::freeLattice(map, seed % 2 == 0 ? Connectivity::kFaces : Connectivity::kVertices);
    const std::vector<CellIndex> walk = walks::randomWalk(lattice, 80, random);
    if (walk.empty()) continue;
    const std::unique_ptr<TautString> string = makeTautString(map, map.centre(walk.front()));
    StackId stack = kStraight;
    std::vector<BandPoint> path{bandPoint(map, map.centre(walk.front()))};
    for (std::size_t i = 1; i < walk.size(); ++i) {
      stack = string->move(stack, map.centre(walk[i - 1]), map.centre(walk[i]));
      path.push_back(bandPoint(map, map.centre(walk[i])));
      if (i % 4 == 0 || i + 1 == walk.size()) {
        expectTight(map, *string, stack, path, "seed " + std::to_string(seed));
        contacts += string->contactCount(stack);
      }
    }
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(contacts, 20000);  // the walks do wind
}

/// Straight moves of any length between points anywhere, on walls and corners too.
std::vector<BandPoint> longWalk(const VoxelMap& map, const BandPoint& start, int moves,
                                walks::Random& random) {
  std::vector<BandPoint> path{start};
  for (int tries = 0; tries < 60 * moves && static_cast<int>(path.size()) <= moves; ++tries) {
    BandPoint p{
        static_cast<std::int64_t>(random() % (1024U * static_cast<unsigned>(map.shape.nz))),
        static_cast<std::int64_t>(random() % (1024U * static_cast<unsigned>(map.shape.nx)))};
    if (random() % 3 == 0) p.u = path.back().u;
    if (random() % 4 == 0) p.u = p.u / 1024 * 1024;
    if (random() % 4 == 0) p.v = p.v / 1024 * 1024;
    if (passable(map, path.back(), p)) path.push_back(p);
  }
  return path;
}

TEST(PlanarString, EqualsTheTightenedPathOnLongMovesAndInPieces) {
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    walks::Random random(seed);
    const GridShape shape{8 + static_cast<int>(seed % 5), 1, 8 + static_cast<int>(seed % 4)};
    const VoxelMap map = walks::clutteredMap(shape, 5 + static_cast<int>(seed % 8), random);
    const std::vector<CellIndex> start =
        walks::randomWalk(walks::freeLattice(map, Connectivity::kFaces), 0, random);
    if (start.empty()) continue;
    PlanarString string(map, map.centre(start.front()));
    const std::vector<BandPoint> path = longWalk(map, bandPoint(map, string.reel()), 12, random);
    StackId stack = kStraight;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Eigen::Vector3d from = pointOf(map, path[i - 1]);
      const Eigen::Vector3d to = pointOf(map, path[i]);
      // In two halves, if the middle is a point of the fine grid.
      const bool even =
          (path[i].u + path[i - 1].u) % 2 == 0 && (path[i].v + path[i - 1].v) % 2 == 0;
      const Eigen::Vector3d middle = 0.5 * (from + to);
      const StackId halved =
          even ? string.move(string.move(stack, from, middle), middle, to) : kStraight;
      stack = string.move(stack, from, to);
      if (even) {
        ASSERT_EQ(stack, halved) << "seed " << seed;
      }
      expectTight(map, string, stack, {path.begin(), path.begin() + static_cast<long>(i) + 1},
                  "seed " + std::to_string(seed) + " move " + std::to_string(i));
      if (HasFatalFailure()) return;
      contacts += string.contactCount(stack);
    }
  }
  EXPECT_GT(contacts, 5000);
}

TEST(PlanarString, IsBackAtTheStartStackAfterTheWayBack) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::clutteredMap({16, 1, 16}, 7, random);
    const std::vector<Eigen::Vector3d> walk = walks::centres(
        map, walks::randomWalk(walks::freeLattice(map, Connectivity::kVertices), 150, random));
    PlanarString string(map, walk.front());
    std::vector<StackId> stacks{kStraight};
    for (std::size_t i = 1; i < walk.size(); ++i) {
      stacks.push_back(string.move(stacks.back(), walk[i - 1], walk[i]));
    }
    StackId stack = stacks.back();
    for (std::size_t i = walk.size() - 1; i > 0; --i) {
      stack = string.move(stack, walk[i], walk[i - 1]);
      ASSERT_EQ(stack, stacks[i - 1]) << "seed " << seed;
    }
  }
}

TEST(PlanarString, EndsOnMovesThroughObstaclesToo) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::clutteredMap({12, 1, 12}, 5, random);
    Eigen::Vector3d at =
        walks::centres(map,
                       walks::randomWalk(walks::freeLattice(map, Connectivity::kFaces), 0, random))
            .front();
    PlanarString string(map, at);
    StackId stack = kStraight;
    for (int i = 0; i < 60; ++i) {
      // Grid points and middles of sides, where ties abound.
      const auto half = [&random] { return 0.25 * static_cast<double>(random() % 25); };
      const Eigen::Vector3d to = map.origin + Eigen::Vector3d(half(), 0.25, half());
      stack = string.move(stack, at, to);
      at = to;
      ASSERT_TRUE(std::isfinite(string.length(stack, at)));
    }
  }
}

TEST(PlanarString, TakesTheReelIntoThePlaneAndWorksFromOutside) {
  VoxelMap map = walks::emptyMap({5, 1, 5});
  walks::occupy(map, {2, 0, 2});
  const Eigen::Vector3d centre = map.centre(map.shape.index({2, 0, 2}));
  // West of the map (low x), a little north; once round the cell from north to east.
  const Eigen::Vector3d reel = centre + Eigen::Vector3d(-4.0, 7.0, 0.0);
  PlanarString string(map, reel);
  EXPECT_DOUBLE_EQ(string.reel().y(), map.origin.y() + 0.25);
  const Eigen::Vector3d start = centre + Eigen::Vector3d(-1.0, 0.0, 0.0);
  const Eigen::Vector3d north = centre + Eigen::Vector3d(0.0, 0.0, 1.0);
  const Eigen::Vector3d east = centre + Eigen::Vector3d(1.0, 0.0, 0.0);
  const StackId stack = string.move(string.move(kStraight, start, north), north, east);
  const std::vector<Eigen::Vector3d> contacts = string.contacts(stack);
  ASSERT_EQ(contacts.size(), 2U);
  EXPECT_TRUE(contacts[0].isApprox(centre + Eigen::Vector3d(-0.25, 0.0, 0.25), 1e-12));
  EXPECT_TRUE(contacts[1].isApprox(centre + Eigen::Vector3d(0.25, 0.0, 0.25), 1e-12));
  EXPECT_TRUE(string.anchor(stack).isApprox(contacts[1], 1e-15));
  EXPECT_NEAR(string.staticLength(stack), std::hypot(3.75, 0.25) + 0.5, 1e-12);
}

}  // namespace
}  // namespace tautline::planning
