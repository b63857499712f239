#include "app/experiments/cluttered_map.h"

#include <algorithm>
#include <queue>
#include <random>

#include <fmt/format.h>

#include "app/experiments/map_world.h"
#include "planning_offline/field/free_space.h"
#include "planning_offline/map/scene_map.h"

namespace tautline::experiments {
namespace {

using planning::CellIndex;

constexpr double kVoxel = 0.4;                  // [m]
const Eigen::Vector3i kCells{18, 9, 13};        // of the room
const Eigen::Vector3d kReel{1.15, 0.75, 2.45};  // [m]
const Eigen::Vector3d kStart{1.0, 1.4, 3.0};    // [m]
constexpr double kRoomToStart = 0.9;            // round reel and start [m]

/// The standard's distributions differ from library to library; its generators do not.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : generator_(seed) {}
  /// 0 … n - 1.
  int roll(int n) { return static_cast<int>(generator_() % static_cast<std::uint32_t>(n)); }

 private:
  std::mt19937 generator_;
};

/// Cells from the lower corner on.
struct Thing {
  Eigen::Vector3i from;
  Eigen::Vector3i size;
};

Thing thingOf(Dice& dice) {
  Thing thing{{dice.roll(kCells.x()), dice.roll(kCells.y()), dice.roll(kCells.z())}, {1, 1, 1}};
  switch (dice.roll(3)) {
    case 0:  // a column, from the floor to some height
      thing.from.y() = 0;
      thing.size.y() = 3 + dice.roll(kCells.y() - 2);
      break;
    case 1:  // a beam
      thing.size[dice.roll(2) == 0 ? 0 : 2] = 2 + dice.roll(4);
      break;
    default:  // a block
      thing.size = {1 + dice.roll(2), 1 + dice.roll(2), 1 + dice.roll(2)};
  }
  thing.size = thing.size.cwiseMin(kCells - thing.from);
  return thing;
}

Box boxOf(const Thing& thing, std::size_t number) {
  return {.name = fmt::format("thing_{}", number),
          .min = kVoxel * thing.from.cast<double>(),
          .max = kVoxel * (thing.from + thing.size).cast<double>()};
}

}  // namespace

planning::VoxelMap clutteredMap(int things, std::uint32_t seed) {
  Scene scene;
  scene.name = fmt::format("clutter_{}_{}", things, seed);
  scene.max = kVoxel * kCells.cast<double>();
  scene.resolution = kVoxel;
  scene.reel = kReel;
  scene.start = kStart;
  Dice dice(seed);
  while (scene.boxes.size() < static_cast<std::size_t>(things)) {
    const Box box = boxOf(thingOf(dice), scene.boxes.size() + 1);
    // The drone takes off to above the start, and the tether is straight then.
    const Eigen::Vector3d above = kStart + Eigen::Vector3d(0.0, 0.3, 0.0);
    const bool near = std::min({signedDistance(kReel, box), signedDistance(kStart, box),
                                signedDistance(0.5 * (kReel + kStart), box),
                                signedDistance(above, box)}) < kRoomToStart;
    if (!near) scene.boxes.push_back(box);
  }
  return planning::sceneMap(sceneText(scene), scene.name + ".scene.toml", {});
}

planning::RiskSpace riskSpaceOf(planning::VoxelMap map, const planning::RiskParams& params) {
  planning::MapSpace space;
  const planning::Progress silent;
  space.lattice =
      std::make_unique<planning::Lattice>(map.shape, planning::Connectivity::kVertices,
                                          planning::freeSpace(map, {.threads = 1}, silent));
  space.map = std::make_shared<const planning::VoxelMap>(std::move(map));
  return planning::makeRiskSpace(std::move(space), params, silent);
}

std::vector<Eigen::Vector3d> goalsIn(const planning::RiskSpace& space, std::size_t count,
                                     double far, std::uint32_t seed) {
  const planning::VoxelMap& map = *space.space.map;
  const planning::Lattice& lattice = *space.space.lattice;
  const CellIndex start = map.indexAt(*map.start);
  std::vector<std::uint8_t> seen(map.shape.size(), 0);
  std::vector<CellIndex> candidates;
  std::queue<CellIndex> queue;
  queue.push(start);
  seen[static_cast<std::size_t>(start)] = 1;
  while (!queue.empty()) {
    const CellIndex u = queue.front();
    queue.pop();
    if ((map.centre(u) - map.centre(start)).norm() >= far) candidates.push_back(u);
    const std::uint32_t moves = lattice.moves(u);
    for (const planning::Direction d : lattice.directions()) {
      if ((moves >> d & 1U) == 0) continue;
      const CellIndex v = lattice.neighbour(u, d);
      if (seen[static_cast<std::size_t>(v)] != 0) continue;
      seen[static_cast<std::size_t>(v)] = 1;
      queue.push(v);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  Dice dice(seed);
  std::vector<Eigen::Vector3d> goals;
  while (goals.size() < count && !candidates.empty()) {
    const auto chosen = candidates.begin() + dice.roll(static_cast<int>(candidates.size()));
    goals.push_back(map.centre(*chosen));
    candidates.erase(chosen);
  }
  return goals;
}

}  // namespace tautline::experiments
