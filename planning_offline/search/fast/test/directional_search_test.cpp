// The fast search and the plain one, label by label.

#include "planning_offline/search/fast/directional_search.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "planning_offline/search/fast/reference/plain_search.h"
#include "planning_offline/search/fast/test/random_costs.h"

namespace tautline::planning {
namespace {

using testing::CostKind;
using testing::RandomCosts;
using testing::randomCosts;
using testing::Turns;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Cost of a path in units, step by step; empty if it is no path on the lattice.
std::optional<std::uint64_t> unitsOfPath(const RandomCosts& costs, const UnitCosts& units,
                                         const std::vector<CellIndex>& path) {
  std::uint64_t sum = 0;
  Direction incoming = kNoDirection;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const GridShape& shape = costs.lattice.shape();
    const Eigen::Vector3i step = shape.cell(path[i]) - shape.cell(path[i - 1]);
    if (step.cwiseAbs().maxCoeff() != 1) return std::nullopt;
    const Direction d = directionOf(step);
    if ((costs.lattice.moves(path[i - 1]) >> d & 1U) == 0) return std::nullopt;
    const std::uint32_t from = units.locale(costs.field.locale[at(path[i - 1])]);
    const std::uint32_t to = units.locale(costs.field.locale[at(path[i])]);
    if (to == UnitCosts::kForbidden) return std::nullopt;
    sum += units.step(d, from, to) + units.turn[at(incoming)][at(d)];
    if (units.hasAccess()) sum += units.access(path[i - 1], path[i]);
    incoming = d;
  }
  return sum;
}

/// True if another label of the cell makes this one needless: no better walk can start with it.
bool isDominated(const UnitCosts& units, const Lattice& lattice, const PlainLabels& plain,
                 CellIndex cell, Direction d) {
  for (const Direction p : lattice.directions()) {
    if (p == d || plain.of(cell, p) == PlainLabels::kUnreached) continue;
    if (plain.of(cell, d) >= plain.of(cell, p) + units.dominated[at(p)][at(d)]) return true;
  }
  return false;
}

struct Counts {
  std::size_t equal{0};
  std::size_t needless{0};
  std::size_t paths{0};
};

void expectEqual(const RandomCosts& costs, int path_every, Counts& counts) {
  const std::optional<UnitCosts> units =
      UnitCosts::make(costs.lattice, costs.field, costs.access());
  ASSERT_TRUE(units);
  const PlainLabels plain = heapSearch(costs.lattice, *units, costs.field.locale, costs.start);
  ASSERT_EQ(plain.label,
            bucketSearch(costs.lattice, *units, costs.field.locale, costs.start).label);
  DirectionalSearch fast(costs.lattice, *units, costs.field.locale, costs.start);
  fast.run(Progress());
  ASSERT_TRUE(fast.complete());

  for (CellIndex cell = 0; cell < static_cast<CellIndex>(costs.lattice.shape().size()); ++cell) {
    const std::uint32_t least = plain.least(cell);
    if (cell == costs.start) {
      ASSERT_EQ(fast.least(cell), 0U);
    } else if (least == PlainLabels::kUnreached) {
      ASSERT_FALSE(fast.least(cell)) << cell;
      ASSERT_TRUE(fast.pathTo(cell).empty());
    } else {
      ASSERT_EQ(fast.least(cell), least) << cell;
    }
    for (const Direction d : costs.lattice.directions()) {
      const std::uint32_t expected = plain.of(cell, d);
      const auto label = fast.label(cell, d);
      if (expected == PlainLabels::kUnreached) {
        ASSERT_FALSE(label) << cell << " " << d;
      } else if (!isDominated(*units, costs.lattice, plain, cell, d)) {
        ASSERT_EQ(label, expected) << cell << " " << d;
        ++counts.equal;
      } else {
        ASSERT_TRUE(!label || *label >= expected) << cell << " " << d;
        ++counts.needless;
      }
    }
    if (cell % path_every != 0 || !fast.least(cell)) continue;
    const std::vector<CellIndex> path = fast.pathTo(cell);
    ASSERT_EQ(path.front(), costs.start);
    ASSERT_EQ(path.back(), cell);
    ASSERT_EQ(unitsOfPath(costs, *units, path), fast.least(cell)) << cell;
    ++counts.paths;
  }
}

std::vector<CostKind> allKinds() {
  std::vector<CostKind> kinds;
  for (const auto connectivity :
       {Connectivity::kFaces, Connectivity::kEdges, Connectivity::kVertices}) {
    for (const bool planar : {false, true}) {
      for (const auto turns :
           {Turns::kConstant, Turns::kLinear, Turns::kQuadratic, Turns::kThreshold, Turns::kAny}) {
        for (int options = 0; options < 16; ++options) {
          kinds.push_back({connectivity, planar, turns, (options & 1) != 0, (options & 2) != 0,
                           (options & 4) != 0, (options & 8) != 0});
        }
      }
    }
  }
  return kinds;
}

TEST(DirectionalSearch, LabelsOfSmallMapsEqualThePlainOnes) {
  std::uint32_t seed = 0;
  Counts counts;
  for (const CostKind& kind : allKinds()) {
    for (int repeat = 0; repeat < 8; ++repeat) {
      ++seed;
      const int n = 2 + static_cast<int>(seed % 5);
      const GridShape shape = kind.planar ? GridShape{2 * n, 1, 11} : GridShape{n, 4, 7 - n / 2};
      SCOPED_TRACE(kind.text() + " seed " + std::to_string(seed));
      expectEqual(randomCosts(shape, 0.05 * static_cast<double>(seed % 9), kind, seed), 1, counts);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(seed, 3000U);
  // Neither side of the comparison is empty.
  EXPECT_GT(counts.equal, 500'000U);
  EXPECT_GT(counts.needless, 500'000U);
  EXPECT_GT(counts.paths, 100'000U);
}

TEST(DirectionalSearch, LabelsOfLargerMapsEqualThePlainOnes) {
  const CostKind constant{};
  const CostKind linear_rate{.turns = Turns::kLinear, .rate = true};
  const CostKind free_ways{.turns = Turns::kLinear, .free_ways = true, .forbidden = true};
  const CostKind access{.turns = Turns::kThreshold, .access = true};
  std::uint32_t seed = 1;
  Counts counts;
  for (const CostKind& kind : {constant, linear_rate, free_ways, access}) {
    SCOPED_TRACE(kind.text());
    expectEqual(randomCosts({40, 38, 36}, 0.1, kind, seed++), 997, counts);
    if (HasFatalFailure()) return;
  }
  expectEqual(randomCosts({300, 1, 200}, 0.2, linear_rate, seed), 997, counts);
}

TEST(DirectionalSearch, TheSameTwice) {
  const RandomCosts costs = randomCosts({20, 20, 20}, 0.2, {.turns = Turns::kLinear}, 5);
  const auto units = UnitCosts::make(costs.lattice, costs.field, {});
  DirectionalSearch a(costs.lattice, *units, costs.field.locale, costs.start);
  DirectionalSearch b(costs.lattice, *units, costs.field.locale, costs.start);
  a.run(Progress());
  b.run(Progress());
  EXPECT_EQ(a.expanded(), b.expanded());
  for (CellIndex cell = 0; cell < 8000; ++cell) ASSERT_EQ(a.pathTo(cell), b.pathTo(cell));
}

TEST(DirectionalSearch, VisitsACellTwiceWhereThatIsBetter) {
  // Up the corridor x = 1 and out to the left at z = 2. That turn is so dear that the walk goes on
  // to the end of the corridor, turns round, and leaves through the same cell from the other side.
  const GridShape shape{2, 1, 4};
  std::vector<std::uint8_t> free(shape.size(), 0);
  for (const auto& [x, z] :
       std::vector<std::pair<int, int>>{{1, 0}, {1, 1}, {1, 2}, {0, 2}, {1, 3}})
    free[at(shape.index({x, 0, z}))] = 1;
  CostField field;
  field.locale.assign(shape.size(), 0.01);
  field.locale_in.fill(1.0);
  field.action.fill(0.01);
  field.turn[at(directionOf({0, 0, 1}))][at(directionOf({-1, 0, 0}))] = 1.0;
  const RandomCosts costs{Lattice(shape, Connectivity::kFaces, free), field,
                          shape.index({1, 0, 0})};
  const auto units = UnitCosts::make(costs.lattice, field, {});
  ASSERT_TRUE(units);
  DirectionalSearch search(costs.lattice, *units, field.locale, costs.start);
  search.run(Progress());
  const CellIndex goal = shape.index({0, 0, 2});
  const std::vector<CellIndex> path = search.pathTo(goal);
  EXPECT_EQ(path.size(), 6U);
  EXPECT_EQ(std::count(path.begin(), path.end(), shape.index({1, 0, 2})), 2);
  EXPECT_EQ(unitsOfPath(costs, *units, path), search.least(goal));
  EXPECT_NEAR(static_cast<double>(*search.least(goal)) * units->unit(), 5 * 0.02, 1e-3);
}

TEST(DirectionalSearch, MemoryIsThatOfFreeCells) {
  const RandomCosts costs = randomCosts({60, 60, 60}, 0.2, {}, 3);
  const auto units = UnitCosts::make(costs.lattice, costs.field, {});
  DirectionalSearch search(costs.lattice, *units, costs.field.locale, costs.start);
  search.run(Progress());
  EXPECT_LE(static_cast<double>(search.bytes()) / static_cast<double>(costs.lattice.freeCount()),
            72.0);
}

TEST(DirectionalSearch, KeepsWhatIsSureWhenCancelled) {
  const RandomCosts costs = randomCosts({30, 30, 30}, 0.1, {.turns = Turns::kLinear}, 9);
  const auto units = UnitCosts::make(costs.lattice, costs.field, {});
  DirectionalSearch whole(costs.lattice, *units, costs.field.locale, costs.start);
  whole.run(Progress());
  int reports = 0;
  const Progress* control = nullptr;
  Progress progress([&](std::string_view, double) {
    if (++reports == 5) const_cast<Progress*>(control)->cancel();
  });
  control = &progress;
  DirectionalSearch part(costs.lattice, *units, costs.field.locale, costs.start);
  part.run(progress);
  EXPECT_FALSE(part.complete());
  std::size_t sure = 0;
  for (CellIndex cell = 0; cell < 27000; ++cell) {
    if (!part.least(cell)) continue;
    ++sure;
    ASSERT_EQ(part.least(cell), whole.least(cell));
    ASSERT_EQ(part.pathTo(cell), whole.pathTo(cell));
  }
  EXPECT_GT(sure, 10U);
  EXPECT_LT(sure, costs.lattice.freeCount() / 2);
}

TEST(DirectionalSearch, AStartThatIsWalledIn) {
  const GridShape shape{3, 3, 3};
  std::vector<std::uint8_t> free(27, 0);
  free[13] = free[0] = 1;
  const Lattice lattice(shape, Connectivity::kVertices, free);
  CostField field;
  field.locale.assign(27, 0.1);
  field.locale_in.fill(1.0);
  const auto units = UnitCosts::make(lattice, field, {});
  ASSERT_TRUE(units);
  DirectionalSearch search(lattice, *units, field.locale, 13);
  search.run(Progress());
  EXPECT_TRUE(search.complete());
  EXPECT_EQ(search.pathTo(13), std::vector<CellIndex>{13});
  EXPECT_FALSE(search.least(0));
  EXPECT_TRUE(search.pathTo(0).empty());
  EXPECT_FALSE(search.least(1));
}

}  // namespace
}  // namespace tautline::planning
