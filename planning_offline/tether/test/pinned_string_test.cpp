#include "planning_offline/tether/pinned_string.h"

#include <cmath>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "planning_offline/tether/planar_string.h"
#include "planning_offline/tether/test/string_line.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

TEST(PinnedString, EqualsTheGoldenContacts) {
  std::ifstream in(TAUTLINE_SOURCE_DIR "/planning_offline/tether/test/golden/contact_3d.json");
  const nlohmann::json golden = nlohmann::json::parse(in);
  for (const auto& scene : golden.at("cases")) {
    const auto& shape = scene.at("shape");
    VoxelMap map = walks::emptyMap({shape[0], shape[1], shape[2]});
    for (const auto& cell : scene.at("occupied")) {
      walks::occupy(map, {cell[0].get<int>(), cell[1].get<int>(), cell[2].get<int>()});
    }
    const auto point = [](const nlohmann::json& p) {
      return Eigen::Vector3d(p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
    };
    const auto metres = [&map](const Eigen::Vector3d& p) {
      return Eigen::Vector3d(map.origin + map.resolution * p);
    };
    Eigen::Vector3d at = metres(point(scene.at("waypoints")[0].at("p")));
    PinnedString string(map, at);
    StackId stack = kStraight;
    for (const auto& waypoint : scene.at("waypoints")) {
      const Eigen::Vector3d to = metres(point(waypoint.at("p")));
      stack = string.move(stack, at, to);
      at = to;
      const std::vector<Eigen::Vector3d> contacts = string.contacts(stack);
      const auto& wanted = waypoint.at("contacts");
      ASSERT_EQ(contacts.size(), wanted.size()) << scene.at("id");
      for (std::size_t i = 0; i < contacts.size(); ++i) {
        EXPECT_LE((contacts[i] - metres(point(wanted[i]))).norm(), 1e-4) << scene.at("id");
        // On the true edge: both components across it are whole.
        const Eigen::Vector3d cells = (contacts[i] - map.origin) / map.resolution;
        for (int axis = 0; axis < 3; ++axis) {
          if (axis == waypoint.at("edge_axis")[i].get<int>()) continue;
          EXPECT_NEAR(cells[axis], std::round(cells[axis]), 1e-12);
        }
      }
      EXPECT_NEAR(string.length(stack, at) / map.resolution, waypoint.at("length").get<double>(),
                  1e-4)
          << scene.at("id");
    }
    EXPECT_EQ(string.unresolvedMoves(), 0);
  }
}

/// The same plan on every level of a map of five levels.
VoxelMap extruded(const VoxelMap& plan) {
  VoxelMap map = walks::emptyMap({plan.shape.nx, 5, plan.shape.nz});
  map.origin = plan.origin;
  for (std::size_t i = 0; i < plan.cells.size(); ++i) {
    if (plan.cells[i] != CellState::kOccupied) continue;
    const Eigen::Vector3i cell = plan.shape.cell(static_cast<CellIndex>(i));
    for (int y = 0; y < 5; ++y) walks::occupy(map, {cell.x(), y, cell.z()});
  }
  return map;
}

TEST(PinnedString, EqualsThePlanarStringOverExtrudedPlans) {
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    walks::Random random(seed);
    const VoxelMap plan = seed % 2 == 0 ? walks::clutteredMap({12, 1, 11}, 8, random)
                                        : walks::boxesMap({14, 1, 14}, 8, 3, random);
    const VoxelMap map = extruded(plan);
    const std::vector<Eigen::Vector3d> walk = walks::centres(
        plan, walks::randomWalk(walks::freeLattice(plan, Connectivity::kVertices), 80, random));
    const Eigen::Vector3d up(0.0, map.resolution * (0.1 + static_cast<double>(seed % 5)), 0.0);
    PlanarString flat(plan, walk.front());
    PinnedString string(map, walk.front() + up);
    StackId planar = kStraight;
    StackId pinned = kStraight;
    for (std::size_t i = 1; i < walk.size(); ++i) {
      planar = flat.move(planar, walk[i - 1], walk[i]);
      pinned = string.move(pinned, walk[i - 1] + up, walk[i] + up);
      ASSERT_NEAR(flat.length(planar, walk[i]), string.length(pinned, walk[i] + up), 1e-5)
          << "seed " << seed << " step " << i;
      for (const Eigen::Vector3d& contact : string.contacts(pinned)) {
        ASSERT_NEAR(contact.y(), string.reel().y(), 1e-9) << "seed " << seed;
      }
      contacts += string.contactCount(pinned);
    }
    for (std::size_t i = walk.size() - 1; i > 0; --i) {
      pinned = string.move(pinned, walk[i] + up, walk[i - 1] + up);
    }
    EXPECT_EQ(pinned, kStraight) << "way back, seed " << seed;
    EXPECT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
  }
  EXPECT_GT(contacts, 30000);
}

TEST(PinnedString, StaysOutsideObstaclesAndBetweenItsBoundsOnRandomWalks) {
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 240; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::spaceMap(seed, random);
    const std::vector<Eigen::Vector3d> walk = walks::spaceWalk(map, 60, random);
    PinnedString string(map, walk.front());
    StackId stack = kStraight;
    double flown = 0.0;
    for (std::size_t i = 1; i < walk.size(); ++i) {
      stack = string.move(stack, walk[i - 1], walk[i]);
      flown += (walk[i] - walk[i - 1]).norm();
      const double length = string.length(stack, walk[i]);
      ASSERT_LE(deepest(map, stringLine(string.reel(), string.contacts(stack), walk[i])), 1e-4)
          << "seed " << seed << " step " << i;
      ASSERT_GE(length, (walk[i] - string.reel()).norm() - 1e-5) << "seed " << seed;
      ASSERT_LE(length, flown + 1e-5) << "seed " << seed;
      contacts += string.contactCount(stack);
    }
    ASSERT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
  }
  EXPECT_GT(contacts, 15000);
}

TEST(PinnedString, ResolvesEveryMoveOfManyWalksAndIsDeterministic) {
  int with_contacts = 0;
  int straight_again = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::spaceMap(seed, random);
    const std::vector<Eigen::Vector3d> walk = walks::spaceWalk(map, 60, random);
    PinnedString string(map, walk.front());
    PinnedString again(map, walk.front());
    StackId stack = kStraight;
    bool contacts = false;
    const auto fly = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
      const StackId same = again.move(stack, from, to);
      stack = string.move(stack, from, to);
      ASSERT_EQ(stack, same) << "seed " << seed;
      contacts = contacts || stack != kStraight;
    };
    for (std::size_t i = 1; i < walk.size(); ++i) fly(walk[i - 1], walk[i]);
    for (std::size_t i = walk.size() - 1; i > 0; --i) fly(walk[i], walk[i - 1]);
    ASSERT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
    with_contacts += contacts ? 1 : 0;
    straight_again += contacts && stack == kStraight ? 1 : 0;
  }
  // Pinned contacts may stay behind, since they do not slide; most walks release them all.
  EXPECT_GT(with_contacts, 2500);
  EXPECT_GT(straight_again, with_contacts / 2);
}

/// True if a straight flight stays clear of obstacles by some 0.05 cells.
bool openFlight(const VoxelMap& map, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const int samples = 1 + static_cast<int>((to - from).norm() / (0.02 * map.resolution));
  for (int k = 0; k <= samples; ++k) {
    for (int n = 0; n < 8; ++n) {
      const Eigen::Vector3d aside((n & 1) - 0.5, (n >> 1 & 1) - 0.5, (n >> 2) - 0.5);
      const CellIndex cell =
          map.indexAt(from + (to - from) * k / samples + 0.1 * map.resolution * aside);
      if (cell != kNoCell && map.cells[static_cast<std::size_t>(cell)] == CellState::kOccupied) {
        return false;
      }
    }
  }
  return true;
}

TEST(PinnedString, LongMovesEqualTheirPieces) {
  int moves = 0;
  int contacts = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::spaceMap(seed, random);
    Eigen::Vector3d at = walks::spaceWalk(map, 0, random).front();
    PinnedString string(map, at);
    StackId stack = kStraight;
    for (int tries = 0; tries < 200; ++tries) {
      Eigen::Vector3d to;
      for (int axis = 0; axis < 3; ++axis) {
        to[axis] = map.origin[axis] + map.resolution * 8e-4 * static_cast<double>(random() % 10000);
      }
      if (!openFlight(map, at, to)) continue;
      StackId pieces = stack;
      for (int k = 0; k < 7; ++k) {
        pieces = string.move(pieces, at + (to - at) * k / 7.0, at + (to - at) * (k + 1) / 7.0);
      }
      stack = string.move(stack, at, to);
      ASSERT_NEAR(string.length(stack, to), string.length(pieces, to), 1e-7) << "seed " << seed;
      ASSERT_EQ(string.contactCount(stack), string.contactCount(pieces)) << "seed " << seed;
      contacts += string.contactCount(stack);
      ++moves;
      at = to;
    }
    EXPECT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
  }
  EXPECT_GT(moves, 2000);
  EXPECT_GT(contacts, 2000);
}

TEST(PinnedString, CountsMovesThroughObstacles) {
  std::int64_t unresolved = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    walks::Random random(seed);
    const VoxelMap map = walks::spaceMap(2 * seed, random);
    const std::vector<Eigen::Vector3d> walk = walks::spaceWalk(map, 0, random);
    PinnedString string(map, walk.front());
    StackId stack = kStraight;
    Eigen::Vector3d at = walk.front();
    for (int i = 0; i < 40; ++i) {
      const Eigen::Vector3d to = map.centre(static_cast<CellIndex>(random() % map.cells.size()));
      stack = string.move(stack, at, to);
      at = to;
      ASSERT_TRUE(std::isfinite(string.length(stack, at)));
    }
    unresolved += string.unresolvedMoves();
  }
  EXPECT_GT(unresolved, 100);
}

}  // namespace
}  // namespace tautline::planning
