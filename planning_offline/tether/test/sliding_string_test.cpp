#include "planning_offline/tether/sliding_string.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/error.h"
#include "planning_offline/tether/edge_equilibrium.h"
#include "planning_offline/tether/pinned_string.h"
#include "planning_offline/tether/planar_string.h"
#include "planning_offline/tether/test/bead_chain.h"
#include "planning_offline/tether/test/prism.h"
#include "planning_offline/tether/test/string_line.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

std::vector<Eigen::Vector3d> lineOf(const SlidingString& string, const Eigen::Vector3d& end) {
  return stringLine(string.reel(), string.contacts(), end);
}

TEST(SlidingString, IsTheShortestOfItsHomotopyClassAmongPrisms) {
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    const PrismWalk walk = prismWalk(seed, 100);
    SlidingString string(walk.map, walk.points.front());
    for (std::size_t i = 1; i < walk.points.size(); ++i) {
      string.moveTo(walk.points[i]);
      if (i % 5 != 0) continue;
      const PrismString wanted = shortestAmongPrisms(walk, i);
      ASSERT_NEAR(string.length(), wanted.length, 1e-4) << "seed " << seed << " step " << i;
      const std::vector<Eigen::Vector3d> got = string.contacts();
      ASSERT_EQ(got.size(), wanted.contacts.size()) << "seed " << seed << " step " << i;
      for (std::size_t k = 0; k < got.size(); ++k) {
        ASSERT_LE((got[k] - wanted.contacts[k]).norm(), 1e-3) << "seed " << seed << " step " << i;
      }
      contacts += static_cast<int>(got.size());
    }
    ASSERT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
  }
  EXPECT_GT(contacts, 30000);
}

TEST(SlidingString, EqualsTheGoldenRefinement) {
  std::ifstream in(TAUTLINE_SOURCE_DIR "/planning_offline/tether/test/golden/contact_3d.json");
  const nlohmann::json golden = nlohmann::json::parse(in);
  for (const auto& scene : golden.at("cases")) {
    const auto& shape = scene.at("shape");
    VoxelMap map = walks::emptyMap({shape[0], shape[1], shape[2]});
    for (const auto& cell : scene.at("occupied"))
      walks::occupy(map, {cell[0].get<int>(), cell[1].get<int>(), cell[2].get<int>()});
    const auto metres = [&map](const nlohmann::json& p) {
      return Eigen::Vector3d(map.origin + map.resolution * Eigen::Vector3d(p[0], p[1], p[2]));
    };
    SlidingString string(map, metres(scene.at("waypoints")[0].at("p")));
    for (const auto& waypoint : scene.at("waypoints")) string.moveTo(metres(waypoint.at("p")));
    const auto& wanted = scene.at("final_geodesic_same_edges");
    EXPECT_NEAR(string.length() / map.resolution, wanted.at("length").get<double>(), 1e-4);
    const std::vector<Eigen::Vector3d> contacts = string.contacts();
    ASSERT_EQ(contacts.size() + 2, wanted.at("points").size()) << scene.at("id");
    for (std::size_t k = 0; k < contacts.size(); ++k)
      EXPECT_LE((contacts[k] - metres(wanted.at("points")[k + 1])).norm(), 1e-4) << scene.at("id");
  }
}

TEST(SlidingString, IsTheSameOnTheWayBackAmongPrisms) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const PrismWalk walk = prismWalk(seed, 60);
    SlidingString string(walk.map, walk.points.front());
    std::vector<double> lengths{0.0};
    for (std::size_t i = 1; i < walk.points.size(); ++i) {
      string.moveTo(walk.points[i]);
      lengths.push_back(string.length());
    }
    for (std::size_t i = walk.points.size() - 1; i > 0; --i) {
      string.moveTo(walk.points[i - 1]);
      ASSERT_NEAR(string.length(), lengths[i - 1], 1e-6) << "seed " << seed << " step " << i;
    }
    EXPECT_TRUE(string.contacts().empty()) << "seed " << seed;
  }
}

TEST(SlidingString, LengthIsConvexOnAStraightWayAmongPrisms) {
  // Of a homotopy class, the shortest length to a point is a convex function of the point as long
  // as the points lie in free space on one line.
  int bent = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const PrismWalk walk = prismWalk(seed, 60);
    SlidingString string(walk.map, walk.points.front());
    for (std::size_t i = 1; i < walk.points.size(); ++i) {
      const double start = string.length();
      const Eigen::Vector3d from = walk.points[i - 1];
      std::array<double, 5> lengths{start};
      for (std::size_t k = 1; k < lengths.size(); ++k) {
        string.moveTo(from + 0.25 * static_cast<double>(k) * (walk.points[i] - from));
        lengths[k] = string.length();
      }
      for (std::size_t k = 1; k + 1 < lengths.size(); ++k) {
        ASSERT_LE(2.0 * lengths[k], lengths[k - 1] + lengths[k + 1] + 1e-5)
            << "seed " << seed << " step " << i;
      }
      bent += string.contacts().empty() ? 0 : 1;
    }
  }
  EXPECT_GT(bent, 5000);
}

TEST(SlidingString, InSpaceStaysOutsideObstaclesAndGrowsNoFasterThanTheWay) {
  int contacts = 0;
  int flights = 0;
  int straight_again = 0;
  for (std::uint64_t seed = 1; seed <= 240; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::spaceMap(seed, random);
    const std::vector<Eigen::Vector3d> walk = walks::spaceWalk(map, 60, random);
    SlidingString string(map, walk.front());
    SlidingString again(map, walk.front());
    for (std::size_t i = 1; i < walk.size(); ++i) {
      const double before = string.length();
      string.moveTo(walk[i]);
      again.moveTo(walk[i]);
      ASSERT_EQ(string.length(), again.length()) << "seed " << seed;
      ASSERT_LE(deepest(map, lineOf(string, walk[i])), 1e-4) << "seed " << seed << " step " << i;
      ASSERT_LE(string.length(), before + (walk[i] - walk[i - 1]).norm() + 1e-5)
          << "seed " << seed << " step " << i;
      ASSERT_GE(string.length(), (walk[i] - string.reel()).norm() - 1e-5);
      contacts += static_cast<int>(string.contacts().size());
    }
    for (std::size_t i = walk.size() - 1; i > 0; --i) string.moveTo(walk[i - 1]);
    ASSERT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
    ++flights;
    straight_again += string.contacts().empty() ? 1 : 0;
  }
  EXPECT_GT(contacts, 8000);
  EXPECT_GT(straight_again, flights * 9 / 10);
}

/// Bars of one cell right through the map, along each axis, and two boxes.
struct Bars {
  VoxelMap map;
  std::vector<std::pair<int, Eigen::Vector3i>> bars;  ///< Axis, and a cell of the bar.
};

Bars crossingBars(walks::Random& random) {
  Bars out{walks::boxesMap({9, 9, 9}, 2, 3, random), {}};
  for (int n = 0; n < 5; ++n) {
    const int axis = n % 3;
    Eigen::Vector3i cell;
    for (int k = 0; k < 3; ++k) cell[k] = 1 + static_cast<int>(random() % 7);
    for (cell[axis] = 0; cell[axis] < 9; ++cell[axis]) walks::occupy(out.map, cell);
    cell[axis] = 0;
    out.bars.emplace_back(axis, cell);
  }
  return out;
}

TEST(SlidingString, StaysInTheHomotopyClassOfTheFlightAmongCrossingBars) {
  int wound = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    walks::Random random(seed);
    const Bars bars = crossingBars(random);
    const std::vector<Eigen::Vector3d> walk = walks::spaceWalk(bars.map, 120, random);
    SlidingString string(bars.map, walk.front());
    std::vector<Eigen::Vector3d> flown{walk.front()};
    for (std::size_t i = 1; i < walk.size(); ++i) {
      string.moveTo(walk[i]);
      flown.push_back(walk[i]);
      std::vector<Eigen::Vector3d> closed = flown;
      const std::vector<Eigen::Vector3d> contacts = string.contacts();
      closed.insert(closed.end(), contacts.rbegin(), contacts.rend());
      for (const auto& [axis, cell] : bars.bars) {
        const Eigen::Vector3d centre = bars.map.centre(bars.map.shape.index(cell));
        ASSERT_EQ(windings(closed, axis, centre), 0) << "seed " << seed << " step " << i;
        wound += windings(flown, axis, centre) != 0 ? 1 : 0;
      }
    }
    ASSERT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
  }
  EXPECT_GT(wound, 2000);  // the flights do go round bars
}

TEST(SlidingString, CannotBePulledTighterInSpace) {
  int bent = 0;
  for (std::uint64_t seed = 1; seed <= 120; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::boxesMap({9, 6, 9}, 6, 4, random);
    const std::vector<Eigen::Vector3d> walk = walks::spaceWalk(map, 40, random);
    SlidingString string(map, walk.front());
    for (std::size_t i = 1; i < walk.size(); ++i) {
      string.moveTo(walk[i]);
      if (i % 5 != 0 || string.contacts().empty()) continue;
      ++bent;
      const double tight = pulledTight(map, lineOf(string, walk[i]));
      EXPECT_GE(tight, string.length() - 0.05 * map.resolution) << "seed " << seed << " step " << i;
    }
  }
  EXPECT_GT(bent, 100);
}

TEST(SlidingString, SlipsOffABoxWhereThePinnedStringStays) {
  // Over a post and on sideways: friction would hold the string on its top edge.
  VoxelMap map = walks::emptyMap({9, 9, 9});
  for (int y = 0; y < 5; ++y) walks::occupy(map, {4, y, 4});
  const auto centre = [&map](int x, int y, int z) {
    return map.centre(map.shape.index({x, y, z}));
  };
  const std::vector<Eigen::Vector3d> flight{centre(0, 4, 4), centre(0, 6, 4), centre(8, 6, 4),
                                            centre(8, 4, 4), centre(8, 4, 8)};
  SlidingString sliding(map, flight.front());
  PinnedString pinned(map, flight.front());
  StackId stack = kStraight;
  for (std::size_t i = 1; i < flight.size(); ++i) {
    sliding.moveTo(flight[i]);
    stack = pinned.move(stack, flight[i - 1], flight[i]);
    if (i == 3) {
      EXPECT_EQ(sliding.contacts().size(), 2U);
      EXPECT_NEAR(sliding.length(), pinned.length(stack, flight[i]), 1e-6);
    }
  }
  EXPECT_EQ(pinned.contactCount(stack), 2);
  EXPECT_TRUE(sliding.contacts().empty());  // the straight line passes beside the post
  EXPECT_LT(sliding.length(), pinned.length(stack, flight.back()) - 0.1);
}

TEST(SlidingString, RefusesAReelInsideAnObstacle) {
  VoxelMap map = walks::emptyMap({3, 3, 3});
  walks::occupy(map, {1, 1, 1});
  EXPECT_THROW(SlidingString(map, map.centre(map.shape.index({1, 1, 1}))), InputError);
}

TEST(EdgeEquilibrium, IsTheShortestLineByBruteForce) {
  walks::Random random(5);
  const auto coordinate = [&random] { return static_cast<double>(random() % 10000) * 1e-3; };
  const auto point = [&] { return Eigen::Vector3d(coordinate(), coordinate(), coordinate()); };
  for (int n = 0; n < 200; ++n) {
    const Eigen::Vector3d a = point();
    const Eigen::Vector3d b = point();
    std::vector<SlidingPoint> points;
    for (int k = 0; k < 1 + n % 4; ++k) {
      const double low = coordinate();
      points.push_back({point(), static_cast<int>(random() % 3), low, low + coordinate()});
    }
    const auto length = [&](const std::vector<SlidingPoint>& at) {
      double sum = 0.0;
      Eigen::Vector3d last = a;
      for (const SlidingPoint& p : at) {
        sum += (p.at - last).norm();
        last = p.at;
      }
      return sum + (b - last).norm();
    };
    findEquilibrium(a, b, points);
    // One point after the other by golden section, again and again: slow and sure.
    std::vector<SlidingPoint> brute = points;
    for (SlidingPoint& p : brute) p.at[p.axis] = 0.5 * (p.low + p.high);
    for (int round = 0; round < 600; ++round) {
      for (SlidingPoint& p : brute) {
        double low = p.low;
        double high = p.high;
        while (high - low > 1e-9) {
          const double third = (high - low) / 3.0;
          p.at[p.axis] = low + third;
          const double left = length(brute);
          p.at[p.axis] = high - third;
          (left < length(brute) ? high : low) = left < length(brute) ? high - third : low + third;
        }
        p.at[p.axis] = 0.5 * (low + high);
      }
      if (n % 4 == 0) break;  // one point: one round
    }
    EXPECT_NEAR(length(points), length(brute), 1e-7) << n;
    for (const SlidingPoint& p : points) {
      EXPECT_TRUE(p.low <= p.at[p.axis] && p.at[p.axis] <= p.high);
    }
  }
}

}  // namespace
}  // namespace tautline::planning
