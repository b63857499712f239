#include "planning_offline/map/load_map.h"

#include <octomap/OcTree.h>

#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/mission/mission_file.h"
#include "planning_offline/map/test/map_files.h"

namespace tautline::planning {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kRoom =
    "version = 1\nname = 'r'\nmin_m = [-1, 0, 0]\nmax_m = [3, 2, 4]\nresolution_m = 0.5\n"
    "reel_m = [0, 0, 0]\n[[boxes]]\nname = 'b'\nmin_m = [1, 0, 1]\nmax_m = [2, 1, 2]\n";

octomap::OcTree smallTree() {
  octomap::OcTree tree(0.1);
  for (int k = 0; k < 200; ++k) {
    tree.updateNode(octomap::point3d(0.1F * static_cast<float>(k % 7) + 0.05F,
                                     0.1F * static_cast<float>(k / 7 % 6) + 0.05F,
                                     0.1F * static_cast<float>(k / 42) + 0.05F),
                    k % 5 == 0);
  }
  return tree;
}

std::string binaryTree() {
  octomap::OcTree tree = smallTree();
  std::ostringstream out;
  tree.writeBinary(out);
  return out.str();
}

std::string fullTree() {
  std::ostringstream out;
  smallTree().write(out);
  return out.str();
}

TEST(LoadMap, KnowsTheFileAndItsHash) {
  const MapFolder folder;
  const std::filesystem::path path = folder.write("room.scene.toml", kRoom);
  const VoxelMap map = loadMap(path, {});
  EXPECT_EQ(map.file, path.string());
  EXPECT_EQ(map.hash, fnv1a(kRoom));
  EXPECT_EQ(map.cells.size(), map.shape.size());
}

TEST(LoadMap, TheContentTellsTheKindAndTheNameMustAgree) {
  const MapFolder folder;
  EXPECT_NO_THROW((void)folder.load("tree.dat", binaryTree()));
  EXPECT_NO_THROW((void)folder.load("tree", fullTree()));
  EXPECT_NO_THROW((void)folder.load("cells.txt", "voxel 1 1 1\n"));
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  struct Case {
    const char* name;
    std::string bytes;
    const char* problem;
  };
  for (const Case& c : {
           Case{"picture.bt", png, "is not an OctoMap binary tree: it starts with '?PNG"},
           Case{"picture.scene.toml", png, "is not a scene: it starts with '?PNG"},
           Case{"picture.png", png, "is not a map: it starts with '?PNG"},
           Case{"tree.map", binaryTree(), "is called .map and is an OctoMap binary tree"},
           Case{"tree.ot", binaryTree(), "is called .ot and is an OctoMap binary tree"},
           Case{"tree.scene.toml", fullTree(), "is called .toml and is an OctoMap tree"},
           Case{"cells.bt", "voxel 1 1 1\n", "is called .bt and is a MovingAI voxel map"},
           Case{"room.3dmap", kRoom, "is not a MovingAI voxel map: it starts with 'version = 1?"},
           Case{"nothing.bt", "", "is an empty file"},
       }) {
    EXPECT_THAT(folder.problem(c.name, c.bytes).problem, HasSubstr(c.problem));
  }
}

TEST(LoadMap, MissingFilesAndFolders) {
  const auto problem = [](const char* path) {
    return problemOf([&] { (void)loadMap(path, {}); }, path).problem;
  };
  EXPECT_THAT(problem("/no/such/map.bt"), HasSubstr("cannot be read"));
  EXPECT_THAT(problem("/tmp"), HasSubstr("is a folder"));
  EXPECT_THAT(problem("/dev/zero"), HasSubstr("is not a regular file"));
}

TEST(LoadMap, OptionsThatMakeNoSense) {
  const MapFolder folder;
  const auto key = [&](const LoadOptions& options) {
    return folder.problem("r.toml", kRoom, options).key;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double r : {0.0, -1.0, 1e-9, 1e9, kNan})
    EXPECT_EQ(key({.resolution = r}), "resolution");
  EXPECT_EQ(key({.crop = Bounds{{0, 0, 0}, {1, 0, 1}}}), "crop");
  EXPECT_EQ(key({.crop = Bounds{{0, 0, kNan}, {1, 1, 1}}}), "crop");
  EXPECT_EQ(key({.slice = kNan}), "slice");
}

TEST(LoadMap, CropAndSliceOutsideSayTheMapsBounds) {
  const MapFolder folder;
  const InputProblem crop =
      folder.problem("r.toml", kRoom, {.crop = Bounds{{3, 0, 0}, {5, 1, 1}}});  // touches a face
  EXPECT_EQ(crop.key, "crop");
  EXPECT_THAT(crop.allowed, HasSubstr("[-1, 0, 0] to [3, 2, 4]"));
  const InputProblem slice = folder.problem("r.toml", kRoom, {.slice = 2.1});
  EXPECT_EQ(slice.key, "slice");
  EXPECT_EQ(slice.allowed, "y from 0 to 2");
  EXPECT_EQ(
      folder.problem("r.toml", kRoom, {.crop = Bounds{{0, 0, 0}, {1, 1, 1}}, .slice = 1.5}).allowed,
      "y from 0 to 1");
}

TEST(LoadMap, SliceTakesTheLayerThatHoldsItsHeight) {
  const MapFolder folder;
  for (const auto& [y, origin] :
       {std::pair{0.0, 0.0}, std::pair{0.49, 0.0}, std::pair{0.5, 0.5}, std::pair{2.0, 1.5}}) {
    const VoxelMap map = folder.load("r.toml", kRoom, {.slice = y});
    EXPECT_EQ(map.shape, (GridShape{8, 1, 8}));
    EXPECT_EQ(map.origin, Eigen::Vector3d(-1, origin, 0));
    EXPECT_EQ(countOf(map, CellState::kOccupied), origin < 1.0 ? 4U : 0U);
  }
}

TEST(LoadMap, AnOpenCropMayBeInfinite) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const VoxelMap map =
      MapFolder().load("r.toml", kRoom, {.crop = Bounds{{0, -kFar, -kFar}, {kFar, kFar, 1}}});
  EXPECT_EQ(map.shape, (GridShape{6, 4, 2}));
}

/// The number before " m fits" of a remedy.
double fittingResolution(const std::string& remedy) {
  const std::size_t end = remedy.find(" m fits");
  const std::size_t begin = remedy.rfind(' ', end - 1);
  return std::stod(remedy.substr(begin, end - begin));
}

TEST(LoadMap, TooMuchMemoryNamesNeedLimitAndAResolutionThatFits) {
  const MapFolder folder;
  for (const bool flat : {false, true}) {
    for (const std::int64_t limit : {5000, 100000, 3000000}) {
      LoadOptions options{.resolution = 0.001, .memory_limit = limit};
      if (flat) options.slice = 0.25;
      const InputProblem problem = folder.problem("r.toml", kRoom, options);
      EXPECT_THAT(problem.problem, flat ? HasSubstr("need 15.26 MiB") : HasSubstr("need 29.8 GiB"));
      options.resolution = fittingResolution(problem.remedy);
      const VoxelMap map = folder.load("r.toml", kRoom, options);
      const auto bytes = static_cast<std::int64_t>(map.cells.size());
      EXPECT_LE(bytes, limit);
      EXPECT_GT(bytes, limit / 3);  // and not much coarser than needed
    }
  }
}

TEST(LoadMap, LayersCountAsMemory) {
  const std::string text =
      kRoom + "[[layers]]\nelement = 'surface'\nmin_m = [0, 0, 0]\nmax_m = [1, 1, 1]\nvalue = 1\n";
  const MapFolder folder;
  EXPECT_NO_THROW((void)folder.load("r.toml", kRoom, {.memory_limit = 1024}));
  EXPECT_THAT(folder.problem("r.toml", text, {.memory_limit = 1024}).problem,
              HasSubstr("need 2.25 KiB"));
}

TEST(LoadMap, EmptyMaps) {
  const MapFolder folder;
  EXPECT_THAT(folder.problem("m.map", "type octile\nheight 1\nwidth 2\nmap\n@@\n").problem,
              HasSubstr("all cells are occupied"));
  octomap::OcTree tree(0.1);
  tree.updateNode(octomap::point3d(0.05F, 0.05F, 0.05F), false);
  tree.updateNode(octomap::point3d(0.95F, 0.95F, 0.95F), false);
  std::ostringstream out;
  tree.writeBinary(out);
  EXPECT_EQ(countOf(folder.load("t.bt", out.str()), CellState::kFree), 2U);
  EXPECT_THAT(
      folder.problem("t.bt", out.str(), {.crop = Bounds{{0.3, 0.3, 0.3}, {0.6, 0.6, 0.6}}}).problem,
      HasSubstr("nothing is known in this part"));
}

/// One damage: some bytes changed, cut, doubled or put in.
std::string damaged(std::string bytes, std::mt19937& random) {
  const auto pick = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  static const std::array<std::string, 8> kInserts{"0",   "9999999999", "-", "nan",
                                                   "1e9", "\n",         " ", std::string(1, '\0')};
  for (std::size_t times = 1 + pick(3); times > 0 && !bytes.empty(); --times) {
    const std::size_t at = pick(bytes.size());
    switch (pick(6)) {
      case 0:
        bytes[at] = static_cast<char>(pick(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << pick(8)));
        break;
      case 2:
        bytes.erase(at, 1 + pick(8));
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, 1 + pick(16)));
        break;
      case 4:
        bytes.insert(at, kInserts[pick(kInserts.size())]);
        break;
      default:
        bytes.resize(at);
        break;
    }
  }
  return bytes;
}

TEST(LoadMap, DamagedFilesGiveAMapOrOneLine) {
  const MapFolder folder;
  const std::array<std::pair<const char*, std::string>, 5> files{{
      {"d.bt", binaryTree()},
      {"d.ot", fullTree()},
      {"d.map", "type octile\nheight 3\nwidth 4\nmap\n.G@.\nOT..\n..SW\n"},
      {"d.3dmap", "voxel 4 5 6\n1 2 3\n3 4 5\n0 0 0\n"},
      {"d.scene.toml", kRoom},
  }};
  std::mt19937 random(2024);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  for (const auto& [name, bytes] : files) {
    int loaded = 0;
    int refused = 0;
    for (int k = 0; k < 300; ++k) {
      const std::string damage = damaged(bytes, random);
      try {
        const VoxelMap map = folder.load(name, damage, {.memory_limit = 1 << 22});
        EXPECT_EQ(map.cells.size(), map.shape.size());
        ++loaded;
      } catch (const InputError& e) {
        EXPECT_FALSE(e.problem().problem.empty());
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        ++refused;
      }
    }
    EXPECT_GT(loaded, 2) << name;
    EXPECT_GT(refused, 100) << name;
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace tautline::planning
