#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planning_offline/map/test/map_files.h"
#include "planning_offline/risk/risk_element.h"

namespace tautline::planning {
namespace {

using ::testing::HasSubstr;

const std::string kFlat =
    "version = 1\nname = 'flat'\nmin_m = [0, 0, 0]\nmax_m = [3, 0.5, 2]\nresolution_m = 0.5\n"
    "reel_m = [0.25, 0.25, 0.25]\n";

std::string box(const std::string& min, const std::string& max) {
  return "[[boxes]]\nname = 'b'\nmin_m = " + min + "\nmax_m = " + max + "\n";
}

std::string layer(const std::string& element, const std::string& min, const std::string& max,
                  const std::string& value) {
  return "[[layers]]\nelement = '" + element + "'\nmin_m = " + min + "\nmax_m = " + max +
         "\nvalue = " + value + "\n";
}

TEST(SceneMap, ARoomOneCellHighIsPlanar) {
  const VoxelMap map = MapFolder().load("flat.scene.toml", kFlat + "start_m = [1, 0.25, 1]\n");
  EXPECT_EQ(map.shape, (GridShape{6, 1, 4}));
  EXPECT_EQ(countOf(map, CellState::kFree), 24U);
  EXPECT_TRUE(map.solid_border);
  EXPECT_EQ(map.name, "flat");
  EXPECT_EQ(*map.reel, Eigen::Vector3d(0.25, 0.25, 0.25));
  EXPECT_EQ(*map.start, Eigen::Vector3d(1, 0.25, 1));
}

TEST(SceneMap, ABoxTakesTheCellsWhoseInteriorItMeets) {
  const MapFolder folder;
  EXPECT_EQ(picture(folder.load("s.toml", kFlat + box("[1, 0, 0.5]", "[2, 0.5, 1]"))),
            "......\n..##..\n......\n......\n");  // faces on faces: only its own cells
  EXPECT_EQ(picture(folder.load("s.toml", kFlat + box("[0.99, 0, 0.5]", "[2.01, 0.5, 1]"))),
            "......\n.####.\n......\n......\n");
  EXPECT_EQ(picture(folder.load("s.toml", kFlat + box("[1.1, 0.2, 0.6]", "[1.2, 0.3, 0.7]"))),
            "......\n..#...\n......\n......\n");  // smaller than a cell
}

/// '!' for cells that the tether must not touch.
std::string marks(const VoxelMap& map) {
  std::string text = picture(map);
  std::size_t cell = 0;
  for (char& c : text) {
    if (c != '\n' && map.no_contact.at(cell++) != 0) c = '!';
  }
  return text;
}

TEST(SceneMap, SharpObstaclesAreMarkedAtEveryResolutionAndInEveryPart) {
  const MapFolder folder;
  const std::string prism =
      "[[prisms]]\nname = 'p'\nfootprint_m = [[1, 2], [1.5, 2], [1.5, 3], [1, 3]]\n"
      "y_min_m = 0\ny_max_m = 1\nsharp = true\n";
  const std::string text = kFlat + box("[0.5, 0, 0.5]", "[2, 0.5, 1]") +
                           box("[1, 0, 0.5]", "[1.5, 0.5, 1]") + "sharp = true\n" + prism;
  EXPECT_EQ(marks(folder.load("s.toml", text)), "......\n.#!#..\n....!!\n......\n");
  const VoxelMap fine = folder.load("s.toml", text, {.resolution = 0.25});
  EXPECT_EQ(std::count(fine.no_contact.begin(), fine.no_contact.end(), 1), 8 + 16);
  EXPECT_EQ(marks(folder.load("s.toml", text, {.crop = Bounds{{1.5, 0, 0}, {3, 1, 2}}})),
            "...\n#..\n.!!\n...\n");
  EXPECT_TRUE(folder.load("s.toml", kFlat + box("[1, 0, 0.5]", "[2, 0.5, 1]")).no_contact.empty());
}

TEST(SceneMap, DecimalFacesAreOnTheFacesOfDecimalCells) {
  // 3 · 0.1 is not 0.3 in binary: without care one of these boxes would take a cell more.
  const std::string room =
      "version = 1\nname = 'r'\nmin_m = [0, 0, 0]\nmax_m = [3, 0.1, 3]\nresolution_m = 0.1\n"
      "reel_m = [2.95, 0.05, 2.95]\n";
  const MapFolder folder;
  for (int i = 0; i < 28; ++i) {
    std::ostringstream text;
    text << room << "[[boxes]]\nname = 'b'\nmin_m = [" << i / 10 << "." << i % 10
         << ", 0, 0]\nmax_m = [" << (i + 1) / 10 << "." << (i + 1) % 10 << ", 0.1, 0.1]\n";
    const VoxelMap map = folder.load("s.toml", text.str());
    EXPECT_EQ(map.shape, (GridShape{30, 1, 30}));
    EXPECT_EQ(countOf(map, CellState::kOccupied), 1U) << i;
    EXPECT_EQ(map.cells[static_cast<std::size_t>(i)], CellState::kOccupied);
  }
}

TEST(SceneMap, RandomBoxesTakeTheCellsTheyMeet) {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> eighth(0, 23);
  const MapFolder folder;
  for (int k = 0; k < 50; ++k) {
    Eigen::Array3i a{eighth(random), eighth(random), eighth(random)};  // in this order
    Eigen::Array3i b{eighth(random), eighth(random), eighth(random)};
    const Eigen::Array3d lo = a.min(b).cast<double>() / 8.0;
    const Eigen::Array3d hi = (a.max(b) + 1).cast<double>() / 8.0;
    if ((lo < 0.1).all()) continue;  // the reel's corner
    std::ostringstream text;
    text << "version = 1\nname = 'r'\nmin_m = [0, 0, 0]\nmax_m = [3, 3, 3]\nresolution_m = 0.5\n"
         << "reel_m = [0, 0, 0]\n[[boxes]]\nname = 'b'\nmin_m = [" << lo.x() << ", " << lo.y()
         << ", " << lo.z() << "]\nmax_m = [" << hi.x() << ", " << hi.y() << ", " << hi.z() << "]\n";
    const VoxelMap map = folder.load("s.toml", text.str());
    for (CellIndex i = 0; i < static_cast<CellIndex>(map.cells.size()); ++i) {
      const Eigen::Array3d cell = map.centre(i).array();
      const bool meets = (cell - 0.25 < hi).all() && (cell + 0.25 > lo).all();
      ASSERT_EQ(map.cells[static_cast<std::size_t>(i)] == CellState::kOccupied, meets);
    }
  }
}

TEST(SceneMap, WhatReachesOutOfTheRoomIsWall) {
  const VoxelMap map = MapFolder().load("s.toml", kFlat, {.resolution = 0.4});
  EXPECT_EQ(map.shape, (GridShape{8, 2, 5}));  // 3.2 x 0.8 x 2 m for a room of 3 x 0.5 x 2 m
  EXPECT_EQ(picture(map),
            ".......#\n.......#\n.......#\n.......#\n.......#\n\n"
            "########\n########\n########\n########\n########\n");
  EXPECT_THAT(MapFolder().problem("s.toml", kFlat, {.resolution = 0.6}).problem,
              HasSubstr("all cells are occupied"));  // no cell fits under the ceiling
}

using Polygon = std::vector<Eigen::Vector2d>;

/// What is left of a polygon on one side of an axis-aligned line (Sutherland and Hodgman, 1974).
Polygon cut(const Polygon& polygon, int axis, double at, double side) {
  Polygon left;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    const double da = side * (a[axis] - at);
    const double db = side * (b[axis] - at);
    if (da >= 0.0) left.push_back(a);
    if (da * db < 0.0) left.push_back(a + (b - a) * da / (da - db));
  }
  return left;
}

double overlap(Polygon polygon, const Eigen::Vector2d& lo, double size) {
  for (int axis = 0; axis < 2; ++axis) {
    polygon = cut(polygon, axis, lo[axis], 1.0);
    polygon = cut(polygon, axis, lo[axis] + size, -1.0);
  }
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return std::abs(area);
}

/// A star about (2, 2), so a simple polygon, mostly not convex; corners on multiples of `grid`.
Polygon star(std::mt19937& random, double grid) {
  std::uniform_real_distribution<double> radius(0.3, 1.9);
  std::uniform_int_distribution<int> corners(3, 9);
  const int n = corners(random);
  Polygon polygon;
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * M_PI * i / n + 0.1;
    const Eigen::Vector2d p =
        Eigen::Vector2d(2, 2) + radius(random) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    polygon.emplace_back(grid * std::round(p.x() / grid), grid * std::round(p.y() / grid));
  }
  return polygon;
}

void checkPrisms(double grid, unsigned seed) {
  std::mt19937 random(seed);
  const MapFolder folder;
  int checked = 0;
  int slivers = 0;
  for (int k = 0; k < 150; ++k) {
    const Polygon footprint = star(random, grid);
    std::ostringstream text;
    text.precision(17);
    text << "version = 1\nname = 'r'\nmin_m = [0, 0, 0]\nmax_m = [4, 0.75, 4]\n"
         << "resolution_m = 0.25\nreel_m = [0, 0, 0]\n[[prisms]]\nname = 'p'\ny_min_m = 0.25\n"
         << "y_max_m = 0.5\nfootprint_m = [";
    for (const Eigen::Vector2d& c : footprint) text << "[" << c.x() << ", " << c.y() << "], ";
    text << "]\n";
    VoxelMap map;
    try {
      map = folder.load("s.toml", text.str());
    } catch (const InputError&) {
      continue;  // rounding to the grid made the polygon touch itself
    }
    ++checked;
    for (CellIndex i = 0; i < static_cast<CellIndex>(map.cells.size()); ++i) {
      const Eigen::Vector3d lo = map.centre(i).array() - 0.125;
      const double area = overlap(footprint, {lo.z(), lo.x()}, 0.25);
      if (area > 0.0 && area < 1e-9) {
        ++slivers;
        continue;
      }
      const bool occupied = map.cells[static_cast<std::size_t>(i)] == CellState::kOccupied;
      ASSERT_EQ(occupied, area > 0.0 && map.shape.cell(i).y() == 1)
          << text.str() << "cell " << map.shape.cell(i).transpose() << " area " << area;
    }
  }
  EXPECT_GT(checked, 60);
  EXPECT_LT(slivers, checked);
}

TEST(SceneMap, PrismsOfAnyShapeTakeTheCellsTheyOverlap) { checkPrisms(1e-9, 5); }

TEST(SceneMap, PrismsWithEdgesAndCornersOnCellFacesTakeNoMore) { checkPrisms(0.25, 6); }

TEST(SceneMap, LayersGoByCellCentreAndLaterRowsHold) {
  const VoxelMap map =
      MapFolder().load("s.toml", kFlat + layer("surface", "[0, 0, 0]", "[3, 1, 1]", "0.25") +
                                     layer("slippage", "[0.5, 0, 0]", "[1, 1, 2]", "1") +
                                     layer("surface", "[1.3, 0, 0.7]", "[2.25, 1, 9]", "0.5"));
  ASSERT_EQ(map.layers.size(), 2U);
  EXPECT_EQ(map.layers[0].name, "surface");
  EXPECT_EQ(map.layers[1].name, "slippage");
  const auto row = [&](std::size_t which, int z) {
    std::vector<double> values;
    for (int x = 0; x < map.shape.nx; ++x) {
      values.push_back(
          map.layers[which].values[static_cast<std::size_t>(map.shape.index({x, 0, z}))]);
    }
    return values;
  };
  using Row = std::vector<double>;
  EXPECT_EQ(row(0, 0), Row({0.25, 0.25, 0.25, 0.25, 0.25, 0.25}));
  // Centres at 1.25, 1.75, 2.25: the box from 1.3 does not hold the first, its face holds the last.
  EXPECT_EQ(row(0, 1), Row({0.25, 0.25, 0.25, 0.5, 0.5, 0.25}));
  EXPECT_EQ(row(0, 2), Row({0, 0, 0, 0.5, 0.5, 0}));
  EXPECT_EQ(row(1, 3), Row({0, 1, 0, 0, 0, 0}));
}

TEST(SceneMap, TheNamesOfLayersAreNamesOfRiskElements) {
  for (const char* name : kMapLayerNames) {
    EXPECT_TRUE(std::any_of(kRiskElementNames.begin(), kRiskElementNames.end(),
                            [&](const auto& entry) { return std::string(entry.name) == name; }))
        << name;
    EXPECT_EQ(MapFolder()
                  .load("s.toml", kFlat + layer(name, "[0, 0, 0]", "[1, 1, 1]", "0.5"))
                  .layers.at(0)
                  .name,
              name);
  }
}

TEST(SceneMap, ErrorsNameTheRow) {
  const MapFolder folder;
  const InputProblem unknown =
      folder.problem("s.toml", kFlat + layer("distance", "[0, 0, 0]", "[1, 1, 1]", "0.5"));
  EXPECT_EQ(unknown.key, "layers[0].element");
  EXPECT_EQ(unknown.line, 8);
  EXPECT_THAT(unknown.allowed, HasSubstr("terrain_stability"));
  EXPECT_EQ(folder.problem("s.toml", kFlat + "colour = 1\n").key, "colour");
  const InputProblem wall =
      folder.problem("s.toml", kFlat + "[[rewards]]\nposition_m = [3, 0.25, 1]\nvalue = 1\n");
  EXPECT_EQ(wall.key, "rewards[0].position_m");
  EXPECT_EQ(wall.line, 8);
  EXPECT_EQ(
      folder.problem("s.toml", kFlat + "[[rewards]]\nposition_m = [4, 0.25, 1]\nvalue = 1\n").key,
      "rewards[0].position_m");
}

TEST(SceneMap, RewardsLandInCellsAndThoseCutOffGo) {
  const std::string text = kFlat +
                           "[[rewards]]\nposition_m = [0.75, 0.25, 1.25]\nvalue = 2\n"
                           "[[rewards]]\nposition_m = [2.75, 0.0, 0.0]\nvalue = 3\n";
  const MapFolder folder;
  const VoxelMap whole = folder.load("s.toml", text);
  ASSERT_EQ(whole.rewards.size(), 2U);
  EXPECT_EQ(whole.indexAt(whole.rewards[0].position), whole.shape.index({1, 0, 2}));
  EXPECT_EQ(whole.indexAt(whole.rewards[1].position), whole.shape.index({5, 0, 0}));
  const VoxelMap part = folder.load("s.toml", text, {.crop = Bounds{{0, 0, 0}, {2, 1, 2}}});
  ASSERT_EQ(part.rewards.size(), 1U);
  EXPECT_EQ(part.rewards[0].value, 2.0);
}

TEST(SceneMap, OnlyTheWholeRoomHasWallsAround) {
  const MapFolder folder;
  const std::string room =
      "version = 1\nname = 'r'\nmin_m = [0, 0, 0]\nmax_m = [2, 2, 2]\nresolution_m = 0.5\n"
      "reel_m = [1, 1, 1]\n";
  EXPECT_TRUE(folder.load("s.toml", room).solid_border);
  EXPECT_TRUE(folder.load("s.toml", room, {.slice = 1.0}).solid_border);  // walls all round
  EXPECT_FALSE(folder.load("s.toml", room, {.crop = Bounds{{0, 0, 0}, {1, 2, 2}}}).solid_border);
  EXPECT_FALSE(folder.load("s.toml", room, {.crop = Bounds{{0, 0, 0}, {2, 1, 2}}}).solid_border);
}

}  // namespace
}  // namespace tautline::planning
