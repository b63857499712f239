// What a tether with contacts reaches under limits, against all that the vehicle can do.

#include "planning_offline/planner/tether_reach.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "planning_offline/search/test/small_world.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {
namespace {

using testing::emptyWorld;
using testing::SmallWorld;

/// Clutter round the reel, which stands in the middle of a free cell.
SmallWorld clutter(GridShape shape, double blocked, std::uint32_t seed) {
  testing::Random random(seed);
  SmallWorld world = emptyWorld(shape, Connectivity::kVertices);
  for (CellState& state : world.map->cells) {
    if (random.uniform(0.0, 1.0) < blocked) state = CellState::kOccupied;
  }
  world.start = static_cast<CellIndex>(random.below(static_cast<int>(shape.size())));
  world.map->cells[static_cast<std::size_t>(world.start)] = CellState::kFree;
  world.map->reel = world.map->centre(world.start);
  world.build();
  return world;
}

TetherReach reachOf(const SmallWorld& world, const TetherLimits& limits) {
  const Progress quiet;
  const ReachMap reach =
      computeReach(*world.map, world.lattice->freeCells(), *world.map->reel, {}, quiet);
  return tetherReach(world.map, *world.lattice, reach, limits, quiet);
}

struct AnyWalk {
  std::size_t cells{0};
  bool all{true};  ///< No state is left to go on from.
};

/// Cells that some walk with the string reaches within the limits; cells not seen yet first.
AnyWalk reachedByAnyWalk(const SmallWorld& world, const TetherLimits& limits) {
  constexpr std::size_t kStates = 1500;
  const VoxelMap& map = *world.map;
  const auto string = makeTautString(map, *map.reel);
  const auto allowed = [&](CellIndex cell, StackId stack) {
    const Eigen::Vector3d seen = map.centre(cell) - string->anchor(stack);
    const double least = limits.elevation_min * 3.14159265358979323846 / 180.0;
    return (limits.length_max <= 0.0 ||
            string->length(stack, map.centre(cell)) <= limits.length_max) &&
           (limits.contacts_max < 0 || string->contactCount(stack) <= limits.contacts_max) &&
           (limits.elevation_min <= -90.0 || seen.norm() == 0.0 ||
            std::atan2(seen.y(), std::hypot(seen.x(), seen.z())) >= least);
  };
  std::set<std::pair<CellIndex, StackId>> known{{world.start, kStraight}};
  std::deque<std::pair<CellIndex, StackId>> open{{world.start, kStraight}};
  std::set<CellIndex> reached;
  if (!allowed(world.start, kStraight)) return {};
  while (!open.empty() && known.size() < kStates) {
    const auto [u, stack] = open.front();
    open.pop_front();
    reached.insert(u);
    for (const Direction d : world.lattice->directions()) {
      if ((world.lattice->moves(u) >> d & 1U) == 0) continue;
      const CellIndex v = world.lattice->neighbour(u, d);
      const StackId next = string->move(stack, map.centre(u), map.centre(v));
      if (!allowed(v, next) || !known.emplace(v, next).second) continue;
      reached.contains(v) ? open.emplace_back(v, next) : open.emplace_front(v, next);
    }
  }
  return {reached.size(), open.empty()};
}

TEST(TetherReach, IsBetweenWhatAnyWalkReachesAndItsBounds) {
  // Of the cells that some walk reaches, the shares that the two ways find: planar, in space.
  std::array<double, 2> found{};
  std::array<double, 2> truth{};
  int exhausted = 0;
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    for (const bool planar : {true, false}) {
      const SmallWorld world =
          planar ? clutter({10, 1, 10}, 0.2, seed) : clutter({4, 4, 4}, 0.2, seed);
      const double length = planar ? 6.0 : 3.0;
      const auto all = reachOf(world, {.length_max = length, .elevation_min = -40.0});
      ASSERT_TRUE(all.complete);
      const auto compare = [&](ReachBounds bounds, const TetherLimits& limits) {
        const AnyWalk any = reachedByAnyWalk(world, limits);
        EXPECT_TRUE(!any.all || bounds.reached <= any.cells) << bounds.reached << " " << any.cells;
        EXPECT_LE(any.cells, bounds.at_most);
        exhausted += any.all ? 1 : 0;
        found[planar ? 0 : 1] += static_cast<double>(bounds.reached);
        truth[planar ? 0 : 1] += static_cast<double>(any.cells);
      };
      const std::size_t connected = all.with_at_most.back().reached;
      compare(all.within_length, {.length_max = length});
      compare(all.within_limits, {.length_max = length, .elevation_min = -40.0});
      compare({all.within_elevation, connected}, {.elevation_min = -40.0});
      for (std::size_t k = 0; k < std::min<std::size_t>(all.with_at_most.size(), 3); ++k) {
        compare(all.with_at_most[k], {.contacts_max = static_cast<int>(k)});
      }
    }
  }
  EXPECT_GT(exhausted, 60);
  EXPECT_GT(found[0], 0.97 * truth[0]);
  EXPECT_GT(found[1], 0.90 * truth[1]);
}

TEST(TetherReach, LimitsThatBindNothingReachAllThatIsConnected) {
  const SmallWorld world = clutter({9, 5, 9}, 0.15, 3);
  const ReachMap plain =
      computeReach(*world.map, world.lattice->freeCells(), *world.map->reel, {}, Progress());
  const TetherReach reach = reachOf(world, {.length_max = 1000.0, .elevation_min = -90.0});
  EXPECT_EQ(reach.within_length.reached, plain.with_contacts_count);
  EXPECT_EQ(reach.within_limits.reached, plain.with_contacts_count);
  EXPECT_EQ(reach.within_elevation, plain.with_contacts_count);
  EXPECT_EQ(reach.with_at_most.back().reached, plain.with_contacts_count);
  EXPECT_EQ(reach.with_at_most.front().at_most, plain.straight_count);
}

TEST(TetherReach, CountsUpToTheContactsAskedFor) {
  // A wall with a gap at its end, a reel behind it: one contact, and two behind the next wall.
  SmallWorld world = emptyWorld({9, 1, 9}, Connectivity::kVertices);
  for (int z = 0; z < 9; ++z) {
    for (const auto& [x, gap] : {std::pair{3, 8}, {6, 0}}) {
      if (z == gap) continue;
      world.map->cells[static_cast<std::size_t>(world.map->shape.index({x, 0, z}))] =
          CellState::kOccupied;
    }
  }
  world.map->reel = world.map->centre(0);
  world.build();
  const TetherReach all = reachOf(world, {});
  const TetherReach two = reachOf(world, {.contacts_max = 1});
  ASSERT_EQ(two.with_at_most.size(), 2U);
  ASSERT_GE(all.with_at_most.size(), 4U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(two.with_at_most[k].reached, all.with_at_most[k].reached);
    EXPECT_GT(all.with_at_most[k + 1].reached, all.with_at_most[k].reached);
    EXPECT_LE(all.with_at_most[k].reached, all.with_at_most[k].at_most);
  }
  EXPECT_EQ(all.with_at_most.back().reached, world.lattice->freeCount());
}

TEST(TetherReach, IsNeverBelowTheStraightTether) {
  std::size_t straight = 0;
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    const SmallWorld world = clutter({7, 7, 7}, 0.15, seed);
    const TetherLimits limits{.length_max = 4.0, .elevation_min = -20.0};
    const ReachMap reach = computeReach(*world.map, world.lattice->freeCells(), *world.map->reel,
                                        {.limits = limits}, Progress());
    const TetherReach with = tetherReach(world.map, *world.lattice, reach, limits, Progress());
    EXPECT_GE(with.within_length.reached, reach.straight_within_length);
    EXPECT_GE(with.within_elevation, reach.straight_within_elevation);
    EXPECT_GE(with.within_limits.reached, reach.straight_within_limits);
    straight += reach.straight_within_limits;
  }
  EXPECT_GT(straight, 400U);
}

/// A wall of sharp cells, x = 3, with a gap at its end: the tether must not touch it.
TEST(TetherReach, KeepsOffForbiddenSurfaces) {
  SmallWorld world = emptyWorld({9, 1, 9}, Connectivity::kVertices);
  for (int z = 0; z < 8; ++z) {
    world.map->cells[static_cast<std::size_t>(world.map->shape.index({3, 0, z}))] =
        CellState::kOccupied;
  }
  world.map->reel = world.map->centre(0);
  world.build();
  const TetherReach blunt = reachOf(world, {.length_max = 30.0});
  EXPECT_EQ(blunt.within_length.reached, world.lattice->freeCount());
  world.map->no_contact.assign(world.map->shape.size(), 0);
  for (std::size_t i = 0; i < world.map->cells.size(); ++i) {
    if (world.map->cells[i] == CellState::kOccupied) world.map->no_contact[i] = 1;
  }
  world.build();
  const ReachMap plain =
      computeReach(*world.map, world.lattice->freeCells(), *world.map->reel, {}, Progress());
  const TetherReach sharp = reachOf(world, {.length_max = 30.0});
  EXPECT_EQ(sharp.within_length.reached, plain.straight_count);
  EXPECT_EQ(sharp.within_limits.reached, plain.straight_count);
  EXPECT_EQ(sharp.with_at_most.size(), 1U);
  EXPECT_EQ(sharp.with_at_most[0].reached, plain.straight_count);
  EXPECT_EQ(sharp.within_length.at_most, world.lattice->freeCount());
  for (std::size_t i = 0; i < sharp.contacts.size(); ++i)
    EXPECT_EQ(sharp.contacts[i], plain.straight[i] != 0 ? 0 : -1) << i;
}

TEST(TetherReach, SaysThatItWasCancelled) {
  const SmallWorld world = clutter({9, 5, 9}, 0.15, 3);
  const ReachMap reach =
      computeReach(*world.map, world.lattice->freeCells(), *world.map->reel, {}, Progress());
  Progress progress;
  progress.cancel();
  EXPECT_FALSE(tetherReach(world.map, *world.lattice, reach, {}, progress).complete);
}

}  // namespace
}  // namespace tautline::planning
