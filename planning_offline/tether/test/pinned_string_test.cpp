#include "planning_offline/tether/pinned_string.h"

#include <cmath>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "planning_offline/tether/planar_string.h"
#include "planning_offline/tether/test/walks.h"

namespace tautline::planning {
namespace {

/// How deep a point is inside the union of the occupied cells, by the largest component of the way
/// out; up to one cell.
double depth(const VoxelMap& map, const Eigen::Vector3d& p_M) {
  const Eigen::Vector3d p = (p_M - map.origin) / map.resolution;
  const Eigen::Vector3i at = p.array().floor().cast<int>();
  double least = 1.0;
  for (int n = 0; n < 27; ++n) {
    const Eigen::Vector3i cell = at + Eigen::Vector3i(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    const bool solid = map.shape.contains(cell) && map.cells[static_cast<std::size_t>(
                                                       map.shape.index(cell))] ==
                                                       CellState::kOccupied;
    if (solid) continue;
    const Eigen::Vector3d low = cell.cast<double>();
    const Eigen::Vector3d out = (low - p).cwiseMax(p - low - Eigen::Vector3d::Ones());
    least = std::min(least, std::max(out.maxCoeff(), 0.0));
  }
  return least;
}

/// Deepest sample of a string; samples are 0.02 cells apart.
double deepest(const VoxelMap& map, const TautString& string, StackId stack,
               const Eigen::Vector3d& end) {
  std::vector<Eigen::Vector3d> points = string.contacts(stack);
  points.insert(points.begin(), string.reel());
  points.push_back(end);
  double most = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector3d d = points[i] - points[i - 1];
    const int samples = 1 + static_cast<int>(d.norm() / (0.02 * map.resolution));
    for (int k = 0; k <= samples; ++k) {
      most = std::max(most, depth(map, points[i - 1] + d * k / samples));
    }
  }
  return most;
}

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
    EXPECT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
  }
  EXPECT_GT(contacts, 30000);
}

TEST(PinnedString, StaysOutsideObstaclesAndBetweenItsBoundsOnRandomWalks) {
  int contacts = 0;
  int moves = 0;
  int returned = 0;
  int walks_with_contacts = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    walks::Random random(seed);
    const GridShape shape{8, 8, 8};
    const VoxelMap map = seed % 2 == 0
                             ? walks::clutteredMap(shape, 4 + static_cast<int>(seed % 9), random)
                             : walks::boxesMap(shape, 14, 4, random);
    const std::vector<Eigen::Vector3d> walk = walks::centres(
        map, walks::randomWalk(walks::freeLattice(map, Connectivity::kVertices), 60, random));
    if (walk.size() < 2) continue;
    PinnedString string(map, walk.front());
    StackId stack = kStraight;
    double flown = 0.0;
    int most = 0;
    for (std::size_t i = 1; i < walk.size(); ++i) {
      stack = string.move(stack, walk[i - 1], walk[i]);
      flown += (walk[i] - walk[i - 1]).norm();
      ++moves;
      const double length = string.length(stack, walk[i]);
      EXPECT_LE(deepest(map, string, stack, walk[i]), 1e-4) << "seed " << seed << " step " << i;
      EXPECT_GE(length, (walk[i] - string.reel()).norm() - 1e-5) << "seed " << seed;
      EXPECT_LE(length, flown + 1e-5) << "seed " << seed;
      contacts += string.contactCount(stack);
      most = std::max(most, string.contactCount(stack));
    }
    EXPECT_EQ(string.unresolvedMoves(), 0) << "seed " << seed;
    for (std::size_t i = walk.size() - 1; i > 0; --i) {
      stack = string.move(stack, walk[i], walk[i - 1]);
    }
    EXPECT_EQ(string.unresolvedMoves(), 0) << "way back, seed " << seed;
    walks_with_contacts += most > 0 ? 1 : 0;
    returned += most > 0 && stack == kStraight ? 1 : 0;
  }
  printf("moves %d contacts %d walks with contacts %d returned %d\n", moves, contacts,
         walks_with_contacts, returned);
}

}  // namespace
}  // namespace tautline::planning
