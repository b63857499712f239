#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planning_offline/map/test/map_files.h"

namespace tautline::planning {
namespace {

using ::testing::HasSubstr;

const std::string kPlaneHeader = "type octile\nheight 3\nwidth 4\nmap\n";
const std::string kPlane = kPlaneHeader + ".G@.\nOT..\n..SW\n";

TEST(MovingAiPlane, ColumnsAreXAndRowsAreZ) {
  const VoxelMap map = MapFolder().load("p.map", kPlane);
  EXPECT_EQ(map.shape, (GridShape{4, 1, 3}));
  EXPECT_TRUE(map.shape.planar());
  EXPECT_EQ(picture(map), "..#.\n##..\n..##\n");
  EXPECT_EQ(map.cells[static_cast<std::size_t>(map.indexAt({2.5, 0.5, 0.5}))],
            CellState::kOccupied);
  EXPECT_EQ(map.resolution, 1.0);
  EXPECT_EQ(map.name, "p");
}

TEST(MovingAiPlane, TakesCrLfAndAnyOrderAndNoLastNewline) {
  const MapFolder folder;
  const std::string expected = picture(folder.load("p.map", kPlane));
  EXPECT_EQ(picture(folder.load("a.map", kPlane.substr(0, kPlane.size() - 1))), expected);
  EXPECT_EQ(picture(folder.load("b.map",
                                "type octile\r\nwidth 4\r\nheight 3\r\nmap\r\n"
                                ".G@.\r\nOT..\r\n..SW\r\n")),
            expected);
}

TEST(MovingAiPlane, AResolutionIsTheSizeOfItsCells) {
  const VoxelMap map = MapFolder().load("p.map", kPlane, {.resolution = 0.3});
  EXPECT_EQ(map.shape, (GridShape{4, 1, 3}));
  EXPECT_EQ(picture(map), "..#.\n##..\n..##\n");
  EXPECT_TRUE(map.centre(0).isApprox(Eigen::Vector3d(0.15, 0.15, 0.15)));
}

TEST(MovingAiPlane, CropIsInMetres) {
  const VoxelMap map = MapFolder().load(
      "p.map", kPlane, {.resolution = 0.1, .crop = Bounds{{0.1, 0, 0.1}, {0.3, 0.1, 0.3}}});
  EXPECT_EQ(picture(map), "#.\n.#\n");
}

TEST(MovingAiPlane, EveryErrorNamesItsLine) {
  const MapFolder folder;
  struct Case {
    std::string text;
    int line;
    std::string problem;
  };
  for (const Case& c : {
           Case{kPlaneHeader + ".G@.\nOT..\n", 6, "ends after 2 rows"},
           Case{kPlaneHeader + ".G@.\nOT..\n..S\n", 7, "row 2 has 3 cells"},
           Case{kPlaneHeader + ".G@.\nOT...\n..SW\n", 6, "row 1 has 5 cells"},
           Case{kPlane + "....\n", 8, "more rows than 3"},
           Case{kPlaneHeader + ".G@.\nOTx.\n..SW\n", 6, "column 2 of the map is 'x'"},
           Case{"type octile\nheight 3\nwidth 4\n", 3, "ends within its header"},
           Case{"type octile\nheight 3\nmap\n", 3, "before both"},
           Case{"type octile\nheight 0\n", 2, "height is '0'"},
           Case{"type octile\nwidth nan\n", 2, "width is 'nan'"},
           Case{"type octile\nwidth 99999999999\n", 2, "width is"},
           Case{"type octile\ndepth 4\n", 2, "is 'depth 4'"},
           Case{"type tile\n", 1, "type 'tile'"},
       }) {
    const InputProblem problem = folder.problem("p.map", c.text);
    EXPECT_EQ(problem.line, c.line) << c.text;
    EXPECT_THAT(problem.problem, HasSubstr(c.problem));
  }
}

TEST(MovingAiPlane, AbsurdSizesAreRefusedBeforeMemoryIsTaken) {
  const InputProblem problem =
      MapFolder().problem("p.map", "type octile\nheight 2000000000\nwidth 2000000000\nmap\n.\n");
  EXPECT_THAT(problem.problem, HasSubstr("need 3.638e+06 TiB"));
  EXPECT_THAT(problem.allowed, HasSubstr("4 GiB"));
}

TEST(MovingAiSpace, AxesAreThoseOfTheMap) {
  const VoxelMap map = MapFolder().load("s.3dmap", "voxel 2 3 4\n1 0 0\n0 2 3\n1 2 3\n1 0 0\n");
  EXPECT_EQ(map.shape, (GridShape{2, 3, 4}));
  EXPECT_EQ(countOf(map, CellState::kOccupied), 3U);
  for (const Eigen::Vector3i& cell :
       {Eigen::Vector3i(1, 0, 0), Eigen::Vector3i(0, 2, 3), Eigen::Vector3i(1, 2, 3)}) {
    EXPECT_EQ(map.cells[static_cast<std::size_t>(map.shape.index(cell))], CellState::kOccupied);
    EXPECT_EQ(map.cellAt(cell.cast<double>() + Eigen::Vector3d(0.5, 0.5, 0.5)), cell);
  }
}

TEST(MovingAiSpace, EveryErrorNamesItsLine) {
  const MapFolder folder;
  struct Case {
    std::string text;
    int line;
    std::string problem;
  };
  for (const Case& c : {
           Case{"voxel 2 3\n", 1, "is 'voxel 2 3'"},
           Case{"voxel 2 3 0\n", 1, "is 'voxel 2 3 0'"},
           Case{"voxel 2 -3 4\n", 1, "is 'voxel 2 -3 4'"},
           Case{"voxel 2 nan 4\n", 1, "is 'voxel 2 nan 4'"},
           Case{"voxel 2 3 4\n1 0 0\n1 0\n", 3, "is '1 0'"},
           Case{"voxel 2 3 4\n1 0 0 0\n", 2, "is '1 0 0 0'"},
           Case{"voxel 2 3 4\n1 0 x\n", 2, "is '1 0 x'"},
           Case{"voxel 2 3 4\n1 0 1.5\n", 2, "is '1 0 1.5'"},
           Case{"voxel 2 3 4\n0 0 4\n", 2, "voxel 0 0 4 is outside the map"},
           Case{"voxel 2 3 4\n0 -1 0\n", 2, "voxel 0 -1 0 is outside the map"},
       }) {
    const InputProblem problem = folder.problem("s.3dmap", c.text);
    EXPECT_EQ(problem.line, c.line) << c.text;
    EXPECT_THAT(problem.problem, HasSubstr(c.problem));
  }
}

TEST(MovingAiSpace, TooMuchMemoryIsRefusedWithNumbers) {
  const InputProblem problem =
      MapFolder().problem("s.3dmap", "voxel 1024 1024 1024\n", {.memory_limit = 1 << 28});
  EXPECT_THAT(problem.problem, HasSubstr("1024 x 1024 x 1024 cells of 1 m need 1 GiB"));
  EXPECT_EQ(problem.allowed, "at most 256 MiB");
  EXPECT_EQ(problem.remedy, "crop the map or allow more memory");
}

TEST(MovingAiSpace, ABigMapCanBeCroppedToFit) {
  const VoxelMap map = MapFolder().load(
      "s.3dmap", "voxel 1000000 1000000 1000000\n999999 5 6\n",
      {.crop = Bounds{{999990, 0, 0}, {1000000, 10, 10}}, .memory_limit = 1 << 20});
  EXPECT_EQ(map.shape, (GridShape{10, 10, 10}));
  EXPECT_EQ(map.cells[static_cast<std::size_t>(map.indexAt({999999.5, 5.5, 6.5}))],
            CellState::kOccupied);
  EXPECT_EQ(countOf(map, CellState::kOccupied), 1U);
}

TEST(MovingAiSpace, TheBenchmarksMapLoads) {
  const std::filesystem::path path = realData() / "movingai3d" / "Simple.3dmap";
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << "REAL DATA MISSING: no " << path << " (set TAUTLINE_DATA)";
  const VoxelMap map = loadMap(path, {});
  EXPECT_EQ(map.shape, (GridShape{105, 132, 105}));
  EXPECT_EQ(countOf(map, CellState::kOccupied), 512U);
}

}  // namespace
}  // namespace tautline::planning
