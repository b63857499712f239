// Tethers of all paths at once against the string moved along each path from its start.

#include "planning_offline/search/path_tethers.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "planning_offline/search/test/small_world.h"

namespace tautline::planning {
namespace {

using testing::emptyWorld;
using testing::Random;
using testing::SmallWorld;

std::size_t at(CellIndex i) { return static_cast<std::size_t>(i); }

/// Clutter, locale risk here and there, a reel away from the start, limits that some paths break.
SmallWorld clutteredWorld(const GridShape& shape, Connectivity connectivity, double blocked,
                          std::uint32_t seed) {
  Random random(seed);
  SmallWorld world = emptyWorld(shape, connectivity);
  VoxelMap& map = *world.map;
  map.resolution = 0.25;
  map.origin = {-1.0, 0.5, 2.0};
  MapLayer surface{"surface", {}};
  for (CellState& state : map.cells) {
    if (random.uniform(0.0, 1.0) < blocked) state = CellState::kOccupied;
    surface.values.push_back(random.below(3) == 0 ? random.uniform(0.0, 0.3) : 0.0);
    map.no_contact.push_back(state == CellState::kOccupied && map.no_contact.size() % 8 == 0);
  }
  map.layers.push_back(std::move(surface));
  const auto anyCell = [&] {
    return static_cast<CellIndex>(random.below(static_cast<int>(shape.size())));
  };
  world.start = anyCell();
  const CellIndex beside = anyCell();
  for (const CellIndex cell : {world.start, beside}) map.cells[at(cell)] = CellState::kFree;
  map.reel = map.centre(seed % 2 == 0 ? world.start : beside);
  world.tethered = true;
  world.params.surface.scale = 1.0;
  world.params.turn = {.law = seed % 3 == 0 ? TurnLaw::kConstant : TurnLaw::kLinear, .risk = 0.05};
  const double size = map.resolution * std::max(shape.nx, shape.nz);
  world.params.tether_limits = {.length_max = 0.6 * size, .elevation_min = -30.0};
  world.build();
  return world;
}

/// What a string says along one path, from the definition.
struct Replay {
  double length{0.0};
  int contacts{0};
  int contacts_most{0};
  bool length_allowed{true};
  bool elevation_allowed{true};
  bool contact_allowed{true};

  Replay(const SmallWorld& world, TautString& string, const std::vector<CellIndex>& path) {
    const TetherLimits& limits = world.params.tether_limits;
    Eigen::Vector3d position = *world.map->reel;
    StackId stack = kStraight;
    for (const CellIndex cell : path) {
      const Eigen::Vector3d next = world.map->centre(cell);
      stack = string.move(stack, position, next);
      position = next;
      length = string.length(stack, position);
      contacts = string.contactCount(stack);
      contacts_most = std::max(contacts_most, contacts);
      if (length > limits.length_max + 1e-9) length_allowed = false;
      for (const Eigen::Vector3d& contact : string.contacts(stack)) {
        for (CellIndex i = 0; i < static_cast<CellIndex>(world.map->no_contact.size()); ++i) {
          if (world.map->no_contact[at(i)] != 0 &&
              (contact - world.map->centre(i)).cwiseAbs().maxCoeff() <
                  0.50001 * world.map->resolution)
            contact_allowed = false;
        }
      }
      const Eigen::Vector3d seen = position - string.anchor(stack);
      const double least = std::tan(limits.elevation_min * 3.14159265358979323846 / 180.0);
      if (seen.y() < least * std::hypot(seen.x(), seen.z()) - 1e-12) elevation_allowed = false;
    }
  }
};

struct Seen {
  int cells{0};
  int contacts{0};
  int too_long{0};
  int too_low{0};
  int forbidden{0};
};

void compare(const SmallWorld& world, const LeastRiskTree& tree, Seen& seen) {
  const PathTethers all = tethersOfPaths(*world.lattice, *world.risk, tree, Progress());
  ASSERT_TRUE(all.complete);
  const auto fresh = makeTautString(*world.map, *world.map->reel);
  for (CellIndex cell = 0; cell < static_cast<CellIndex>(world.map->shape.size()); ++cell) {
    const std::vector<CellIndex> path = tree.pathTo(cell);
    if (path.empty()) {
      ASSERT_TRUE(std::isinf(all.length[at(cell)]));
      ASSERT_EQ(all.contacts[at(cell)], -1);
      ASSERT_EQ(all.contacts_most[at(cell)], -1);
      ASSERT_EQ(all.length_allowed[at(cell)], 0);
      ASSERT_EQ(all.elevation_allowed[at(cell)], 0);
      ASSERT_EQ(all.contact_allowed[at(cell)], 0);
      continue;
    }
    const Replay replay(world, *world.risk->string(), path);
    ASSERT_EQ(all.length[at(cell)], replay.length) << cell;
    const Replay alone(world, *fresh, path);  // interns in another order
    ASSERT_NEAR(all.length[at(cell)], alone.length, world.map->shape.planar() ? 0.0 : 1e-7) << cell;
    ASSERT_EQ(all.contacts[at(cell)], alone.contacts) << cell;
    ASSERT_EQ(all.contacts[at(cell)], replay.contacts) << cell;
    ASSERT_EQ(all.contacts_most[at(cell)], replay.contacts_most) << cell;
    ASSERT_EQ(all.length_allowed[at(cell)] != 0, replay.length_allowed) << cell;
    ASSERT_EQ(all.elevation_allowed[at(cell)] != 0, replay.elevation_allowed) << cell;
    ASSERT_EQ(all.contact_allowed[at(cell)] != 0, replay.contact_allowed) << cell;
    ++seen.cells;
    seen.contacts += replay.contacts_most;
    seen.too_long += replay.length_allowed ? 0 : 1;
    seen.too_low += replay.elevation_allowed ? 0 : 1;
    seen.forbidden += replay.contact_allowed ? 0 : 1;
  }
}

TEST(PathTethers, EqualEachPathFlownFromItsStart) {
  Seen planar;
  Seen space;
  for (std::uint32_t seed = 0; seed < 24; ++seed) {
    for (const auto connectivity : {Connectivity::kFaces, Connectivity::kVertices}) {
      SCOPED_TRACE(seed);
      const SmallWorld plane = clutteredWorld({24, 1, 21}, connectivity, 0.15, seed);
      const SmallWorld room = clutteredWorld({9, 7, 8}, connectivity, 0.12, 100 + seed);
      for (const bool fast : {false, true}) {
        const auto treeOf = [&](const SmallWorld& w) {
          return fast ? leastRiskTreeFast(*w.lattice, *w.risk, w.start, 1, Progress())
                      : leastRiskTreeReference(*w.lattice, *w.risk, w.start, Progress());
        };
        compare(plane, *treeOf(plane), planar);
        compare(room, *treeOf(room), space);
        if (HasFatalFailure()) return;
      }
    }
  }
  for (const Seen& seen : {planar, space}) {
    EXPECT_GT(seen.cells, 20000);
    EXPECT_GT(seen.contacts, 20000);
    EXPECT_GT(seen.too_long, 1000);
    EXPECT_GT(seen.forbidden, 1000);
  }
  EXPECT_GT(space.too_low, 1000);
}

TEST(PathTethers, MoveTheStringOnceAComponent) {
  const SmallWorld world = clutteredWorld({16, 1, 16}, Connectivity::kVertices, 0.1, 7);
  const auto tree = leastRiskTreeReference(*world.lattice, *world.risk, world.start, Progress());
  std::vector<std::pair<CellIndex, Direction>> components;
  std::size_t steps = 0;
  for (CellIndex cell = 0; cell < 256; ++cell) {
    steps += tree->pathTo(cell).size();
    std::optional<WalkEnd> end = tree->lastOf(cell);
    while (end) {
      components.emplace_back(end->cell, end->incoming);
      if (end->incoming == kNoDirection) break;
      end = tree->before(*end);
    }
  }
  EXPECT_EQ(components.size(), steps);
  std::sort(components.begin(), components.end());
  components.erase(std::unique(components.begin(), components.end()), components.end());
  EXPECT_EQ(tethersOfPaths(*world.lattice, *world.risk, *tree, Progress()).moves,
            components.size());
  EXPECT_LT(components.size(), steps / 3);
}

TEST(PathTethers, OfAForbiddenStartThereAreNone) {
  SmallWorld world = emptyWorld({3, 1, 1}, Connectivity::kFaces);
  world.map->layers = {{"surface", {1.0, 0.0, 0.0}}};
  world.params.surface.scale = 1.0;
  world.tethered = true;
  world.build();
  const auto tree = leastRiskTreeReference(*world.lattice, *world.risk, 0, Progress());
  const PathTethers all = tethersOfPaths(*world.lattice, *world.risk, *tree, Progress());
  EXPECT_EQ(all.contacts, (std::vector<std::int32_t>{-1, -1, -1}));
  EXPECT_EQ(all.moves, 0U);
}

TEST(PathTethers, SayThatTheyWereCancelled) {
  const SmallWorld world = clutteredWorld({16, 1, 16}, Connectivity::kVertices, 0.1, 7);
  const auto tree = leastRiskTreeReference(*world.lattice, *world.risk, world.start, Progress());
  Progress progress;
  progress.cancel();
  const PathTethers all = tethersOfPaths(*world.lattice, *world.risk, *tree, progress);
  EXPECT_FALSE(all.complete);
  EXPECT_EQ(std::count(all.contacts.begin(), all.contacts.end(), -1), 256);
}

}  // namespace
}  // namespace tautline::planning
