#include "planning_offline/field/benchmark/benchmark_scene.h"

#include <cstdlib>
#include <filesystem>
#include <random>

#include "planning_offline/field/reference/synthetic_map.h"

namespace tautline::planning {
namespace {

octomap::point3d pointOf(const Eigen::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

BenchmarkScene makeRooms() {
  BenchmarkScene scene;
  scene.map = roomsMap({100, 100, 100}, 1);
  scene.tree = std::make_unique<octomap::OcTree>(scene.map.resolution);
  for (std::size_t i = 0; i < scene.map.cells.size(); ++i) {
    scene.tree->updateNode(pointOf(scene.map.centre(static_cast<CellIndex>(i))),
                           scene.map.cells[i] == CellState::kOccupied, true);
  }
  scene.tree->updateInnerOccupancy();
  scene.tree->prune();
  return scene;
}

BenchmarkScene readBuilding(const std::filesystem::path& file) {
  BenchmarkScene scene;
  scene.tree = std::make_unique<octomap::OcTree>(file.string());
  octomap::OcTree& tree = *scene.tree;
  tree.expand();
  octomap::OcTreeKey low(65535, 65535, 65535);
  octomap::OcTreeKey high(0, 0, 0);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    for (unsigned k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], leaf.getKey()[k]);
      high[k] = std::max(high[k], leaf.getKey()[k]);
    }
  }
  scene.map.name = file.filename().string();
  scene.map.resolution = tree.getResolution();
  scene.map.shape = {high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1};
  const octomap::point3d corner = tree.keyToCoord(low);
  scene.map.origin = Eigen::Vector3f(corner.x(), corner.y(), corner.z()).cast<double>().array() -
                     0.5 * scene.map.resolution;
  scene.map.cells.assign(scene.map.shape.size(), CellState::kUnknown);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const octomap::OcTreeKey& key = leaf.getKey();
    const Eigen::Vector3i cell(key[0] - low[0], key[1] - low[1], key[2] - low[2]);
    scene.map.cells[static_cast<std::size_t>(scene.map.shape.index(cell))] =
        tree.isNodeOccupied(*leaf) ? CellState::kOccupied : CellState::kFree;
  }
  tree.prune();
  return scene;
}

}  // namespace

const BenchmarkScene& roomsScene() {
  static const BenchmarkScene scene = makeRooms();
  return scene;
}

const BenchmarkScene* buildingScene() {
  static const std::filesystem::path file = [] {
    const char* data = std::getenv("TAUTLINE_DATA");
    return std::filesystem::path(data != nullptr ? data : TAUTLINE_SOURCE_DIR "/../shared/data") /
           "octomap" / "geb079.bt";
  }();
  if (!std::filesystem::exists(file)) return nullptr;
  static const BenchmarkScene scene = readBuilding(file);
  return &scene;
}

std::vector<std::pair<CellIndex, CellIndex>> randomPairs(const VoxelMap& map, int count,
                                                         std::uint32_t seed) {
  std::vector<CellIndex> free;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (map.cells[i] == CellState::kFree) free.push_back(static_cast<CellIndex>(i));
  }
  std::mt19937 random(seed);
  std::uniform_int_distribution<std::size_t> pick(0, free.size() - 1);
  std::vector<std::pair<CellIndex, CellIndex>> pairs;
  for (int n = 0; n < count; ++n) {
    const CellIndex from = free[pick(random)];
    pairs.emplace_back(from, free[pick(random)]);
  }
  return pairs;
}

}  // namespace tautline::planning
