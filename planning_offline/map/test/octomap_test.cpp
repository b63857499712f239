#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <array>
#include <random>
#include <sstream>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planning_offline/map/octomap_file.h"
#include "planning_offline/map/test/map_files.h"

namespace tautline::planning {
namespace {

using ::testing::HasSubstr;

constexpr double kLeaf = 0.125;

octomap::point3d pointAt(const Eigen::Vector3d& p_file) {
  return {static_cast<float>(p_file.x()), static_cast<float>(p_file.y()),
          static_cast<float>(p_file.z())};
}

/// Blocks of free and occupied leaves, so that some are pruned and some space stays unknown.
template <class Tree>
void fill(Tree& tree, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> corner(-8, 6);
  std::uniform_int_distribution<int> size(1, 6);
  for (int block = 0; block < 12; ++block) {
    const Eigen::Vector3i lo{corner(random), corner(random), corner(random)};  // in this order
    const int n = size(random);
    for (int k = 0; k < n * n * n; ++k) {
      const Eigen::Vector3i leaf = lo + Eigen::Vector3i(k % n, k / n % n, k / (n * n));
      tree.updateNode(pointAt((leaf.cast<double>().array() + 0.5) * kLeaf), block % 3 == 0);
    }
  }
  tree.updateInnerOccupancy();
  tree.prune();
}

std::string binaryBytes(octomap::OcTree& tree) {
  std::ostringstream out;
  EXPECT_TRUE(tree.writeBinary(out));
  return out.str();
}

std::string fullBytes(const octomap::AbstractOcTree& tree) {
  std::ostringstream out;
  EXPECT_TRUE(tree.write(out));
  return out.str();
}

template <class Tree>
CellState stateAt(const Tree& tree, const Eigen::Vector3d& p_M) {
  const auto* node = tree.search(pointAt(toZUp(p_M)));
  if (node == nullptr) return CellState::kUnknown;
  return tree.isNodeOccupied(node) ? CellState::kOccupied : CellState::kFree;
}

/// The worst that liboctomap says of any of n^3 points within the cell.
template <class Tree>
CellState worstIn(const Tree& tree, const VoxelMap& map, CellIndex cell, int n) {
  bool unknown = false;
  for (int k = 0; k < n * n * n; ++k) {
    const Eigen::Array3d at(k % n, k / n % n, k / (n * n));
    const Eigen::Vector3d offset = (at + 0.5) / n - 0.5;
    const CellState state = stateAt(tree, map.centre(cell) + map.resolution * offset);
    if (state == CellState::kOccupied) return state;
    unknown |= state == CellState::kUnknown;
  }
  return unknown ? CellState::kUnknown : CellState::kFree;
}

TEST(OctomapFile, AxesTurnWithoutMirroring) {
  EXPECT_EQ(fromZUp(Eigen::Vector3d(1, 2, 3)), Eigen::Vector3d(2, 3, 1));
  EXPECT_EQ(toZUp(fromZUp(Eigen::Vector3d(1, 2, 3))), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(fromZUp(Eigen::Vector3d::UnitZ()), Eigen::Vector3d::UnitY());
  EXPECT_EQ(fromZUp(Eigen::Vector3d::UnitX()).cross(fromZUp(Eigen::Vector3d::UnitY())),
            fromZUp(Eigen::Vector3d::UnitZ()));
}

TEST(OctomapFile, EveryCellIsAsItsTreeSaysAtEveryResolution) {
  const MapFolder folder;
  for (unsigned seed = 0; seed < 12; ++seed) {
    octomap::OcTree tree(kLeaf);
    fill(tree, seed);
    const std::string bytes = binaryBytes(tree);
    // Samples so close that each leaf that meets a cell has one: leaf / 4, off all faces.
    for (const auto& [ratio, samples] : {std::pair{0.5, 2}, std::pair{1.0, 4}, std::pair{1.5, 6},
                                         std::pair{2.0, 8}, std::pair{3.0, 12}}) {
      LoadOptions options;
      if (ratio != 1.0) options.resolution = ratio * kLeaf;
      const VoxelMap map = folder.load("random.bt", bytes, options);
      EXPECT_EQ(map.resolution, ratio * kLeaf);
      for (CellIndex i = 0; i < static_cast<CellIndex>(map.cells.size()); ++i) {
        ASSERT_EQ(map.cells[static_cast<std::size_t>(i)], worstIn(tree, map, i, samples))
            << "seed " << seed << " ratio " << ratio << " at " << map.centre(i).transpose();
      }
      EXPECT_GT(countOf(map, CellState::kOccupied), 0U);
      EXPECT_GT(countOf(map, CellState::kUnknown), 0U);
    }
  }
}

TEST(OctomapFile, TheGridIsTheTreesMetricBox) {
  octomap::OcTree tree(kLeaf);
  fill(tree, 3);
  const VoxelMap map = MapFolder().load("box.bt", binaryBytes(tree));
  Eigen::Vector3d lo;
  Eigen::Vector3d hi;
  tree.getMetricMin(lo.x(), lo.y(), lo.z());
  tree.getMetricMax(hi.x(), hi.y(), hi.z());
  EXPECT_EQ(map.origin, fromZUp(lo));
  EXPECT_EQ(map.origin + map.resolution * Eigen::Vector3d(map.shape.nx, map.shape.ny, map.shape.nz),
            fromZUp(hi));
  EXPECT_EQ(map.name, "box");
  EXPECT_FALSE(map.solid_border);
}

TEST(OctomapFile, FullTreesOfAllKindsAreReadAlike) {
  const MapFolder folder;
  octomap::OcTree tree(kLeaf);
  octomap::ColorOcTree colour(kLeaf);
  fill(tree, 5);
  fill(colour, 5);
  const VoxelMap binary = folder.load("a.bt", binaryBytes(tree));
  const VoxelMap full = folder.load("a.ot", fullBytes(tree));
  const VoxelMap coloured = folder.load("c.ot", fullBytes(colour));
  EXPECT_EQ(full.cells, binary.cells);
  EXPECT_EQ(coloured.cells, binary.cells);
  EXPECT_EQ(full.origin, binary.origin);
  EXPECT_NE(full.hash, binary.hash);
}

TEST(OctomapFile, CropAndSliceKeepTheCellsOfTheWholeGrid) {
  const MapFolder folder;
  octomap::OcTree tree(kLeaf);
  fill(tree, 7);
  const std::string bytes = binaryBytes(tree);
  const VoxelMap whole = folder.load("t.bt", bytes);
  const Bounds box{whole.origin + Eigen::Vector3d(2.5, 3, 5.25) * kLeaf,
                   whole.origin + Eigen::Vector3d(12.5, 12, 12) * kLeaf};
  const auto check = [&](const LoadOptions& options, const GridShape& shape,
                         const Eigen::Vector3d& first) {
    const VoxelMap part = folder.load("t.bt", bytes, options);
    EXPECT_EQ(part.shape, shape);
    EXPECT_EQ(part.origin, whole.origin + first * kLeaf);
    for (CellIndex i = 0; i < static_cast<CellIndex>(part.cells.size()); ++i) {
      EXPECT_EQ(part.cells[static_cast<std::size_t>(i)],
                whole.cells[static_cast<std::size_t>(whole.indexAt(part.centre(i)))]);
    }
  };
  LoadOptions options;
  options.crop = box;
  check(options, {11, 9, 7}, {2, 3, 5});
  options.slice = whole.origin.y() + 7.5 * kLeaf;
  check(options, {11, 1, 7}, {2, 7, 5});
  options.crop.reset();
  check(options, {whole.shape.nx, 1, whole.shape.nz}, {0, 7, 0});
}

TEST(OctomapFile, EveryTruncationIsAnErrorAndNothingIsPrinted) {
  const MapFolder folder;
  octomap::OcTree tree(kLeaf);
  fill(tree, 9);
  const std::array files{std::pair{"t.bt", binaryBytes(tree)}, std::pair{"t.ot", fullBytes(tree)}};
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  for (const auto& [name, bytes] : files) {
    for (std::size_t size = 0; size < bytes.size(); size += size < 200 ? 1 : 17) {
      (void)folder.problem(name, bytes.substr(0, size));
    }
    const std::string all = bytes.substr(0, bytes.size() - 1);
    EXPECT_THAT(folder.problem(name, all).problem, HasSubstr("the file ends after"));
    EXPECT_THAT(folder.problem(name, all).remedy, HasSubstr("truncated"));
    EXPECT_THAT(folder.problem(name, bytes + "x").problem, HasSubstr("1 bytes follow"));
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

std::string binaryFile(const std::string& id, const std::string& size, const std::string& res,
                       const std::string& data) {
  return std::string(kOctomapBinaryHeader) + "\nid " + id + "\nsize " + size + "\nres " + res +
         "\ndata\n" + data;
}

TEST(OctomapFile, ImpossibleTreesAreRefused) {
  const MapFolder folder;
  const auto problem = [&](const std::string& bytes) { return folder.problem("t.bt", bytes); };
  const std::string leaf("\x01\x00", 2);  // one free child
  EXPECT_EQ(folder.load("t.bt", binaryFile("OcTree", "2", "0.01", leaf), {.resolution = 20.0})
                .shape.size(),
            17U * 17U * 17U);  // an eighth of the tree: 32768 leaves of 0.01 m
  EXPECT_EQ(problem(binaryFile("OcTree", "3", "0.1", leaf)).problem,
            "has 2 nodes; its header promises 3");
  EXPECT_THAT(problem(binaryFile("OcTree", "0", "0.1", "")).problem, HasSubstr("empty map"));
  EXPECT_THAT(problem(binaryFile("OcTree", "1", "0.1", std::string(2, '\0'))).problem,
              HasSubstr("empty map"));
  EXPECT_THAT(problem(binaryFile("OcTree", "2", "0.1", std::string("\x03\x00\x00\x00", 4))).problem,
              HasSubstr("no children"));
  EXPECT_THAT(problem(binaryFile("OcTree", "99999", "0.1", std::string(1000, '\xff'))).problem,
              HasSubstr("deeper than 16 levels"));
  EXPECT_EQ(problem(binaryFile("CountingOcTree", "2", "0.1", leaf)).key, "id");
  for (const char* res : {"0", "-1", "nan", "inf", "1e-9", "1e300", "0.1x"}) {
    EXPECT_EQ(problem(binaryFile("OcTree", "2", res, leaf)).line, 4) << res;
  }
  for (const char* size : {"-1", "x", "99999999999999999999"}) {
    EXPECT_EQ(problem(binaryFile("OcTree", size, "0.1", leaf)).line, 3) << size;
  }
}

TEST(OctomapFile, OccupancyThatIsNoNumberIsRefused) {
  octomap::OcTree tree(kLeaf);
  fill(tree, 1);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    leaf->setLogOdds(std::numeric_limits<float>::quiet_NaN());
  }
  EXPECT_THAT(MapFolder().problem("t.ot", fullBytes(tree)).problem, HasSubstr("not a number"));
}

TEST(OctomapFile, RealBuildingsAreAsTheirTreesSay) {
  struct Real {
    const char* name;
    GridShape shape;
    std::size_t free;
    std::size_t occupied;
    std::size_t unknown;
  };
  for (const Real& real : {Real{"geb079.bt", {187, 39, 487}, 950759, 185673, 2415259},
                           Real{"upo_stage_1.bt", {200, 200, 400}, 15850417, 149583, 0}}) {
    const std::filesystem::path path = realData() / "octomap" / real.name;
    if (!std::filesystem::exists(path))
      GTEST_SKIP() << "REAL DATA MISSING: no " << path << " (set TAUTLINE_DATA)";
    const VoxelMap map = loadMap(path, {});
    EXPECT_EQ(map.shape, real.shape);
    EXPECT_EQ(countOf(map, CellState::kFree), real.free);
    EXPECT_EQ(countOf(map, CellState::kOccupied), real.occupied);
    EXPECT_EQ(countOf(map, CellState::kUnknown), real.unknown);
    octomap::OcTree tree(path.string());
    std::mt19937 random(1);
    std::uniform_int_distribution<CellIndex> cell(0, static_cast<CellIndex>(map.cells.size() - 1));
    for (int k = 0; k < 100000; ++k) {
      const CellIndex i = cell(random);
      ASSERT_EQ(map.cells[static_cast<std::size_t>(i)], stateAt(tree, map.centre(i)));
    }
  }
}

}  // namespace
}  // namespace tautline::planning
