#include "planning_offline/planner/contact_bound.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "planning_offline/planner/flat_index.h"
#include "planning_offline/search/least_risk_tree.h"
#include "planning_offline/search/test/small_world.h"
#include "planning_offline/tether/taut_string.h"

namespace tautline::planning {
namespace {

using testing::emptyWorld;
using testing::SmallWorld;

SmallWorld dust(GridShape shape, std::uint32_t seed, double blocked) {
  testing::Random random(seed);
  SmallWorld world = emptyWorld(shape, Connectivity::kEdges);
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const bool near = shape.cell(static_cast<CellIndex>(i)).sum() < 3;
    const bool taken = random.uniform(0.0, 1.0) < blocked && !near;
    world.map->cells[i] = taken ? CellState::kOccupied : CellState::kFree;
  }
  world.build();
  return world;
}

/// Least contacts in each cell of the strings that the vehicle can get, the nearest ones first; int
/// max where it was not seen with one.
std::vector<int> leastContacts(const SmallWorld& world) {
  constexpr std::size_t kStates = 4000;
  const auto string = makeTautString(*world.map, world.map->centre(0));
  std::vector<int> least(world.map->shape.size(), std::numeric_limits<int>::max());
  std::set<std::pair<CellIndex, StackId>> seen{{0, kStraight}};
  std::deque<std::pair<CellIndex, StackId>> open{{0, kStraight}};
  while (!open.empty() && seen.size() < kStates) {
    const auto [u, stack] = open.front();
    open.pop_front();
    int& here = least[static_cast<std::size_t>(u)];
    here = std::min(here, string->contactCount(stack));
    for (const Direction d : world.lattice->directions()) {
      if ((world.lattice->moves(u) >> d & 1U) == 0) continue;
      const CellIndex v = world.lattice->neighbour(u, d);
      const StackId next = string->move(stack, world.map->centre(u), world.map->centre(v));
      if (seen.emplace(v, next).second) open.emplace_back(v, next);
    }
  }
  return least;
}

TEST(ContactBound, IsNeverAboveWhatAStringHasAndMostlyThat) {
  int cells = 0;
  int equal = 0;
  int more_than_one = 0;
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    const SmallWorld world = dust({9, 1, 9}, seed, 0.25);
    const std::vector<int> least = leastContacts(world);
    ContactBound bound(*world.map, world.map->centre(0));
    for (std::size_t i = 0; i < least.size(); ++i) {
      if (least[i] == std::numeric_limits<int>::max()) continue;
      const int contacts = bound.at(static_cast<CellIndex>(i));
      ASSERT_LE(contacts, least[i]) << "seed " << seed << " cell " << i;
      ++cells;
      if (contacts == least[i]) ++equal;
      if (contacts > 1) ++more_than_one;
    }
  }
  EXPECT_GT(cells, 500);
  EXPECT_GT(equal, cells * 2 / 3);  // lines between corners need not be taut round them
  EXPECT_GT(more_than_one, cells / 20);
}

TEST(ContactBound, HoldsInSpace) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const SmallWorld world = dust({4, 3, 4}, seed, 0.3);
    const std::vector<int> least = leastContacts(world);
    ContactBound bound(*world.map, world.map->centre(0));
    for (std::size_t i = 0; i < least.size(); ++i) {
      ASSERT_LE(bound.at(static_cast<CellIndex>(i)), least[i]) << "seed " << seed << " cell " << i;
    }
  }
}

TEST(ContactBound, StaysValidWhereThereAreTooManyCorners) {
  const SmallWorld world = dust({120, 1, 120}, 1, 0.2);
  ContactBound bound(*world.map, world.map->centre(0));
  ContactBound again(*world.map, world.map->centre(0));
  const auto string = makeTautString(*world.map, world.map->centre(0));
  const auto tree = leastRiskTreeReference(*world.lattice, *world.risk, 0, Progress());
  int checked = 0;
  for (CellIndex goal = 0; goal < static_cast<CellIndex>(world.map->shape.size()); goal += 999) {
    const std::vector<CellIndex> path = tree->pathTo(goal);
    StackId stack = kStraight;
    for (std::size_t i = 1; i < path.size(); ++i) {
      stack = string->move(stack, world.map->centre(path[i - 1]), world.map->centre(path[i]));
      ASSERT_EQ(bound.at(path[i]), again.at(path[i]));
      ASSERT_LE(bound.at(path[i]), string->contactCount(stack));
      ++checked;
    }
  }
  EXPECT_GT(checked, 300);
}

TEST(FlatIndex, KeepsWhatItWasTold) {
  FlatIndex index;
  testing::Random random(1);
  std::vector<FlatIndex::Key> keys;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const auto key =
        static_cast<FlatIndex::Key>(random.below(1 << 30)) << 33 | static_cast<FlatIndex::Key>(i);
    keys.push_back(key);
    ASSERT_EQ(index[key], FlatIndex::kNew);
    index[key] = i;
  }
  EXPECT_EQ(index.size(), keys.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) ASSERT_EQ(index[keys[i]], i);
  index.clear();
  EXPECT_EQ(index.size(), 0U);
  EXPECT_EQ(index[keys[0]], FlatIndex::kNew);
}

}  // namespace
}  // namespace tautline::planning
