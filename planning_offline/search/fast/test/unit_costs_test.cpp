// Whole units: never above the costs they stand for, near them, and refused where they cannot be.

#include "planning_offline/search/fast/unit_costs.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "planning_offline/search/fast/test/random_costs.h"

namespace tautline::planning {
namespace {

using testing::CostKind;
using testing::RandomCosts;
using testing::randomCosts;
using testing::Turns;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

TEST(UnitCosts, AreBelowTheCostsByLittle) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    const CostKind kind{
        .turns = static_cast<Turns>(seed % 5), .rate = seed % 2 == 0, .access = seed % 3 == 0};
    SCOPED_TRACE(kind.text());
    const RandomCosts costs = randomCosts({6, 6, 6}, 0.1, kind, seed);
    const auto units = UnitCosts::make(costs.lattice, costs.field, costs.access());
    ASSERT_TRUE(units);
    EXPECT_FALSE(units->raised());
    double cheapest = std::numeric_limits<double>::infinity();
    for (CellIndex u = 0; u < 216; ++u) {
      for (const Direction d : costs.lattice.directions()) {
        if ((costs.lattice.moves(u) >> d & 1U) == 0) continue;
        const CellIndex v = costs.lattice.neighbour(u, d);
        const Direction p = (u + d) % (kDirections + 1);
        const std::uint32_t step = units->step(d, units->locale(costs.field.locale[at(u)]),
                                               units->locale(costs.field.locale[at(v)]));
        const std::uint32_t access = units->hasAccess() ? units->access(u, v) : 0;
        const double sum =
            units->unit() * static_cast<double>(step + access + units->turn[at(p)][at(d)]);
        const double cost = costs.stepCost(u, p, d);
        ASSERT_LE(sum, cost * (1.0 + 1e-14));
        ASSERT_GE(sum, cost - 9.0 * units->unit());
        // A bucket is no wider than the cheapest step, and labels stay within 16 bits of it.
        ASSERT_GE(step, 1U << units->shift());
        ASSERT_LE((1U << units->shift()) + step + access + 3 * units->turnMax(), 65000U);
        cheapest = std::min(cheapest, cost - costs.field.turn[at(p)][at(d)]);
      }
    }
    EXPECT_LT(units->unit(), cheapest / 64.0);
  }
}

TEST(UnitCosts, StepsOfNoCostAreRaisedToAUnit) {
  const RandomCosts costs = randomCosts({6, 6, 6}, 0.1, {.free_ways = true}, 4);
  const auto units = UnitCosts::make(costs.lattice, costs.field, {});
  ASSERT_TRUE(units);
  EXPECT_TRUE(units->raised());
  EXPECT_EQ(units->step(0, 0, 0), 1U);
  EXPECT_LE(units->unit(), UnitCosts::kUnitMax);
}

TEST(UnitCosts, DominatedIsWhatATurnCanMakeUpFor) {
  const RandomCosts costs = randomCosts({4, 4, 4}, 0.1, {.turns = Turns::kAny}, 8);
  const auto units = UnitCosts::make(costs.lattice, costs.field, {});
  ASSERT_TRUE(units);
  for (const Direction p : costs.lattice.directions()) {
    EXPECT_EQ(units->dominated[at(p)][at(p)], 0);
    for (const Direction q : costs.lattice.directions()) {
      for (const Direction e : costs.lattice.directions()) {
        EXPECT_LE(units->turn[at(p)][at(e)],
                  units->turn[at(q)][at(e)] + units->dominated[at(p)][at(q)]);
      }
    }
  }
}

TEST(UnitCosts, RefusesWhatSixteenBitsCannotHold) {
  RandomCosts costs = randomCosts({4, 4, 4}, 0.0, {.turns = Turns::kLinear}, 2);
  ASSERT_TRUE(UnitCosts::make(costs.lattice, costs.field, {}));
  // A turn 10^4 times as dear as the cheapest step.
  CostField field = costs.field;
  field.turn[2][3] = 400.0;
  EXPECT_FALSE(UnitCosts::make(costs.lattice, field, {}));
  // Turns and actions of certain failure.
  field = costs.field;
  field.turn[2][3] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(UnitCosts::make(costs.lattice, field, {}));
  field = costs.field;
  field.action[5] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(UnitCosts::make(costs.lattice, field, {}));
  // An access element that can be certain failure.
  field = costs.field;
  field.character.assign(64, 1.0F);
  EXPECT_FALSE(UnitCosts::make(costs.lattice, field, [](CellIndex, CellIndex) {
    return std::numeric_limits<double>::infinity();
  }));
  // Directions that the lattice does not have do not matter.
  const Lattice faces({4, 4, 4}, Connectivity::kFaces, std::vector<std::uint8_t>(64, 1));
  field = costs.field;
  field.action[0] = std::numeric_limits<double>::infinity();
  field.turn[0][0] = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(UnitCosts::make(faces, field, {}));
}

}  // namespace
}  // namespace tautline::planning
