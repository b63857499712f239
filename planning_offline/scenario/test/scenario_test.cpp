#include "planning_offline/scenario/scenario.h"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planning_offline/map/test/map_files.h"
#include "planning_offline/scenario/shortest_path.h"

namespace tautline::planning {
namespace {

using ::testing::HasSubstr;

std::vector<std::uint8_t> randomCells(const GridShape& shape, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution free(share);
  std::vector<std::uint8_t> cells(shape.size());
  for (std::uint8_t& cell : cells) cell = free(random) ? 1 : 0;
  return cells;
}

/// Lengths of all shortest paths from one cell: relaxes every move until nothing changes.
std::vector<double> relaxed(const Lattice& lattice, CellIndex start) {
  std::vector<double> length(lattice.shape().size(), std::numeric_limits<double>::infinity());
  if (lattice.free(start)) length[static_cast<std::size_t>(start)] = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (CellIndex i = 0; i < static_cast<CellIndex>(length.size()); ++i) {
      for (const Direction d : lattice.directions()) {
        if (((lattice.moves(i) >> d) & 1U) == 0) continue;
        double& other = length[static_cast<std::size_t>(lattice.neighbour(i, d))];
        const double way = length[static_cast<std::size_t>(i)] + stepLength(d);
        if (way < other - 1e-9) {
          other = way;
          changed = true;
        }
      }
    }
  }
  return length;
}

TEST(ShortestPath, EqualsRelaxationOnRandomMaps) {
  const Progress progress;
  std::size_t found = 0;
  std::size_t none = 0;
  for (unsigned seed = 0; seed < 30; ++seed) {
    const GridShape shape = seed % 2 == 0 ? GridShape{6, 5, 4} : GridShape{9, 1, 8};
    for (const Connectivity connectivity :
         {Connectivity::kFaces, Connectivity::kEdges, Connectivity::kVertices}) {
      const Lattice lattice(shape, connectivity, randomCells(shape, 0.7, seed));
      ShortestPath search(lattice);
      for (CellIndex start = 0; start < static_cast<CellIndex>(shape.size()); start += 17) {
        const std::vector<double> expected = relaxed(lattice, start);
        for (CellIndex goal = 0; goal < static_cast<CellIndex>(shape.size()); ++goal) {
          const std::optional<double> length = search.length(start, goal, progress);
          const double truth = expected[static_cast<std::size_t>(goal)];
          ASSERT_EQ(length.has_value(), std::isfinite(truth));
          if (!length) {
            ++none;
            continue;
          }
          ++found;
          ASSERT_NEAR(*length, truth, 1e-9);
          ASSERT_LE(octileDistance(shape.cell(start), shape.cell(goal), connectivity),
                    truth + 1e-9);
        }
      }
    }
  }
  EXPECT_GT(found, 10000U);
  EXPECT_GT(none, 1000U);
}

TEST(ShortestPath, InFreeSpaceIsTheOctileDistance) {
  const Progress progress;
  const GridShape shape{7, 5, 6};
  for (const Connectivity connectivity :
       {Connectivity::kFaces, Connectivity::kEdges, Connectivity::kVertices}) {
    const Lattice lattice(shape, connectivity, std::vector<std::uint8_t>(shape.size(), 1));
    ShortestPath search(lattice);
    for (CellIndex goal = 0; goal < static_cast<CellIndex>(shape.size()); ++goal) {
      ASSERT_NEAR(*search.length(0, goal, progress),
                  octileDistance({0, 0, 0}, shape.cell(goal), connectivity), 1e-9);
    }
  }
  EXPECT_DOUBLE_EQ(octileDistance({0, 0, 0}, {1, -2, 4}, Connectivity::kVertices),
                   std::sqrt(3.0) + std::sqrt(2.0) + 2.0);
}

// Rows:  . . @ .   The way from (1, 0) to (3, 0) must go round the wall below without cutting it;
//        . . @ .   a diagonal beside a blocked cell would make it 2 - √2 shorter at each corner.
//        . . . .
const std::string kMap = "type octile\nheight 3\nwidth 4\nmap\n..@.\n..@.\n....\n";
constexpr const char* kScen =
    "version 1\n"
    "0\tw.map\t4\t3\t0\t0\t1\t1\t1.41421356\n"
    "1\tw.map\t4\t3\t1\t0\t3\t0\t6.00000000\n"
    "1\tw.map\t4\t3\t0\t1\t3\t2\t3.41421\n"
    "0\tw.map\t4\t3\t2\t2\t2\t2\t0\n";

TEST(Scenarios, PlanarOnesAreReadAndEqual) {
  const ScenarioFile scenarios = parseScenarios(kScen, "w.map.scen");
  EXPECT_TRUE(scenarios.planar);
  EXPECT_EQ(scenarios.map, "w.map");
  ASSERT_EQ(scenarios.rows.size(), 4U);
  EXPECT_EQ(scenarios.rows[1].line, 3);
  EXPECT_EQ(scenarios.rows[1].start, Eigen::Vector3i(1, 0, 0));
  EXPECT_EQ(scenarios.rows[2].goal, Eigen::Vector3i(3, 0, 2));
  const ScenarioReport report =
      checkScenarios(MapFolder().load("w.map", kMap), scenarios, Progress());
  ASSERT_EQ(report.rows.size(), 4U);
  for (const ScenarioResult& row : report.rows) {
    EXPECT_TRUE(row.equal) << row.scenario.line << ": " << row.found.value_or(-1.0);
  }
  EXPECT_EQ(report.mismatches, 0U);
  EXPECT_TRUE(report);
}

TEST(Scenarios, ALengthThatCutsCornersOrHasNoPathIsAMismatch) {
  const MapFolder folder;
  const auto check = [&](const std::string& row) {
    const ScenarioReport report = checkScenarios(
        folder.load("w.map", kMap), parseScenarios("version 1.0\n" + row + "\n", "s"), Progress());
    EXPECT_FALSE(report);
    EXPECT_EQ(report.mismatches, 1U);
    return report.rows.at(0);
  };
  EXPECT_NEAR(*check("0 w.map 4 3 1 0 3 0 4.82842712").found, 6.0, 1e-12);
  EXPECT_FALSE(check("0 w.map 4 3 0 0 2 0 2.0").found);  // the goal is blocked
  EXPECT_TRUE(check("0 w.map 4 3 0 0 1 1 1.41421400").found);
}

TEST(Scenarios, InSpaceNoCellBesideTheStepMayBeBlocked) {
  // One blocked cell on the spanned box is enough to take the diagonal away.
  const MapFolder folder;
  const std::string row = "version 1\ns.3dmap\n0 0 0 1 1 1 ";
  const auto equal = [&](const std::string& voxel, const std::string& length) {
    return checkScenarios(folder.load("s.3dmap", "voxel 2 2 2\n" + voxel),
                          parseScenarios(row + length + " 1.0\n", "s"), Progress())
        .rows.at(0)
        .equal;
  };
  EXPECT_TRUE(equal("", "1.73205081"));
  EXPECT_FALSE(equal("1 0 0\n", "1.73205081"));
  EXPECT_TRUE(equal("1 0 0\n", "2.41421356"));  // over (0, 1, 0) or (0, 0, 1)
  EXPECT_TRUE(equal("1 1 0\n", "2.41421356"));
  EXPECT_TRUE(equal("1 0 0\n0 1 1\n", "3.00000000"));
}

TEST(Scenarios, EveryErrorNamesItsLine) {
  struct Case {
    std::string text;
    int line;
    std::string problem;
  };
  const std::string row = "0 w.map 4 3 0 0 1 1 1.4\n";
  for (const Case& c : {
           Case{"", 0, "starts with ''"},
           Case{"version 2\n", 1, "starts with 'version 2'"},
           Case{"version 1\n", 1, "ends after its version"},
           Case{"version 1\ns.3dmap\n", 2, "no scenarios"},
           Case{"version 1\ns.3dmap\n1 2 3 4 5 6 7.0\n", 3, "has 7 words"},
           Case{"version 1\ns.3dmap\n1 2 3 4 5 -6 7.0 1.0\n", 3, "number 6 is '-6'"},
           Case{"version 1\ns.3dmap\n1 2 3 4 5 6 nan 1.0\n", 3, "length is 'nan'"},
           Case{"version 1\ns.3dmap\n1 2 3 4 5 6 7.0 x\n", 3, "ratio is 'x'"},
           Case{"version 1\n0 w.map 4 3 0 0 1 1\n", 2, "has 8 words"},
           Case{"version 1\n0 w.map 4 3 0 0 1 1.5 1.4\n", 2, "number 8 is '1.5'"},
           Case{"version 1\n" + row + "0 v.map 4 3 0 0 1 1 1.4\n", 3, "is about map 'v.map'"},
           Case{"version 1\n" + row + "0 w.map 5 3 0 0 1 1 1.4\n", 3, "with 5 x 3 cells"},
       }) {
    const InputProblem problem = problemOf([&] { (void)parseScenarios(c.text, "s"); }, c.text);
    EXPECT_EQ(problem.line, c.line) << c.text;
    EXPECT_THAT(problem.problem, HasSubstr(c.problem));
  }
}

TEST(Scenarios, AnotherMapIsRefused) {
  const MapFolder folder;
  const VoxelMap plane = folder.load("w.map", kMap);
  const VoxelMap space = folder.load("s.3dmap", "voxel 4 3 3\n");
  const ScenarioFile planar = parseScenarios(kScen, "s");
  const ScenarioFile spatial = parseScenarios("version 1\ns.3dmap\n0 0 0 3 3 1 5 1\n", "s");
  const auto problem = [](const VoxelMap& map, const ScenarioFile& scenarios) {
    return problemOf([&] { (void)checkScenarios(map, scenarios, Progress()); });
  };
  EXPECT_THAT(problem(space, planar).problem, HasSubstr("for a map of 4 x 1 x 3 cells"));
  EXPECT_THAT(problem(plane, spatial).problem, HasSubstr("this one is planar"));
  EXPECT_THAT(problem(space, spatial).problem, HasSubstr("outside the map of 4 x 3 x 3"));
  EXPECT_EQ(problem(space, spatial).line, 3);
  const VoxelMap part =
      folder.load("s.3dmap", "voxel 5 4 4\n", {.crop = Bounds{{1, 1, 1}, {5, 4, 4}}});
  EXPECT_THAT(problem(part, spatial).problem, HasSubstr("cropped"));
}

TEST(Scenarios, CancellingKeepsWhatIsDone) {
  const VoxelMap map = MapFolder().load("w.map", kMap);
  Progress* self = nullptr;
  int reports = 0;
  Progress progress([&](std::string_view, double fraction) {
    EXPECT_DOUBLE_EQ(fraction, reports / 4.0);
    if (++reports == 3) self->cancel();
  });
  self = &progress;
  const ScenarioReport report = checkScenarios(map, parseScenarios(kScen, "s"), progress);
  EXPECT_TRUE(report.cancelled);
  EXPECT_FALSE(report);
  EXPECT_EQ(report.rows.size(), 2U);
  EXPECT_EQ(report.mismatches, 0U);
}

TEST(Scenarios, AllPublishedOptimaOfTheBenchmarkAreFound) {
  const std::filesystem::path folder = realData() / "movingai3d";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "REAL DATA MISSING: no " << folder << " (set TAUTLINE_DATA)";
  const ScenarioFile scenarios = readScenarios(folder / "Simple_500.3dscen");
  EXPECT_FALSE(scenarios.planar);
  EXPECT_EQ(scenarios.map, "Simple.3dmap");
  const ScenarioReport report =
      checkScenarios(loadMap(folder / "Simple.3dmap", {}), scenarios, Progress());
  ASSERT_EQ(report.rows.size(), 500U);
  EXPECT_EQ(report.mismatches, 0U);
  for (const ScenarioResult& row : report.rows) {
    EXPECT_LE(std::abs(row.found.value_or(-1.0) - row.scenario.length), 1e-8);
  }
}

}  // namespace
}  // namespace tautline::planning
