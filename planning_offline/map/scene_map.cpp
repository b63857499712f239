#include "planning_offline/map/scene_map.h"

#include <algorithm>
#include <cmath>

#include "common/error.h"
#include "common/mission/scene.h"
#include "common/toml/toml_file.h"
#include "common/toml/toml_writer.h"
#include "planning_offline/map/raster.h"

namespace tautline::planning {
namespace {

constexpr double kShrink = 1e-6;  // [cells]; as in raster.h, what is nearer counts as touching

std::size_t at(CellIndex i) { return static_cast<std::size_t>(i); }

/// The column of cells through (x, z), a little smaller, between the prism's floor and ceiling.
Box columnAt(const VoxelMap& map, int x, int z, const Prism& prism) {
  const double gap = kShrink * map.resolution;
  const Eigen::Vector3d lo = map.origin + map.resolution * Eigen::Vector3d(x, 0, z);
  return {"",
          {lo.x() + gap, prism.y_min, lo.z() + gap},
          {lo.x() + map.resolution - gap, prism.y_max, lo.z() + map.resolution - gap}};
}

Bounds boundsOf(const Prism& prism) {
  Bounds bounds;
  bounds.min = bounds.max = {prism.footprint[0].y(), prism.y_min, prism.footprint[0].x()};
  bounds.max.y() = prism.y_max;
  for (const Eigen::Vector2d& corner : prism.footprint) {
    const Eigen::Vector2d p(corner.y(), corner.x());  // (x, z)
    bounds.min.x() = std::min(bounds.min.x(), p.x());
    bounds.min.z() = std::min(bounds.min.z(), p.y());
    bounds.max.x() = std::max(bounds.max.x(), p.x());
    bounds.max.z() = std::max(bounds.max.z(), p.y());
  }
  return bounds;
}

/// A column meets the prism if an edge of the footprint runs through it, or else if its middle is
/// inside: without an edge it is wholly inside or wholly outside.
bool meets(const Box& column, const Prism& prism) {
  const double y = 0.5 * (prism.y_min + prism.y_max);
  const std::vector<Eigen::Vector2d>& corners = prism.footprint;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Eigen::Vector3d a(corners[j].y(), y, corners[j].x());
    const Eigen::Vector3d b(corners[i].y(), y, corners[i].x());
    if (intersect(a, b, column)) return true;
  }
  return signedDistance(0.5 * (column.min + column.max), prism) < 0.0;
}

void markBox(VoxelMap& map, const Box& box) {
  mark(map, {box.min, box.max}, CellState::kOccupied);
  if (box.sharp) forbidContact(map, cellsMeeting(map, {box.min, box.max}));
}

void markPrism(VoxelMap& map, const Prism& prism) {
  const CellRange range = cellsMeeting(map, boundsOf(prism));
  for (int z = range.lo.z(); z <= range.hi.z(); ++z) {
    for (int x = range.lo.x(); x <= range.hi.x(); ++x) {
      if (range.lo.y() > range.hi.y() || !meets(columnAt(map, x, z, prism), prism)) continue;
      const CellRange column{{x, range.lo.y(), z}, {x, range.hi.y(), z}};
      forEachCell(map.shape, column, [&](CellIndex i) { map.cells[at(i)] = CellState::kOccupied; });
      if (prism.sharp) forbidContact(map, column);
    }
  }
}

bool hasSharp(const Scene& scene) {
  const auto sharp = [](const auto& obstacle) { return obstacle.sharp; };
  return std::any_of(scene.boxes.begin(), scene.boxes.end(), sharp) ||
         std::any_of(scene.prisms.begin(), scene.prisms.end(), sharp);
}

/// The row of an error is found in the file's text.
[[noreturn]] void failAt(std::string_view text, const std::string& file, InputProblem problem) {
  throw TomlFile::parse(text, file).locate(InputError(std::move(problem)));
}

std::string layerNames() {
  std::string names;
  for (const char* name : kMapLayerNames) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

void checkLayers(const Scene& scene, std::string_view text, const std::string& file) {
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    const std::string& name = scene.layers[i].element;
    if (std::find(kMapLayerNames.begin(), kMapLayerNames.end(), name) != kMapLayerNames.end())
      continue;
    failAt(text, file,
           {.key = "layers[" + std::to_string(i) + "].element",
            .problem = "is '" + name + "', no risk element that reads a layer",
            .allowed = layerNames()});
  }
}

/// Number of different elements among the layers.
std::size_t layerCount(const Scene& scene) {
  return static_cast<std::size_t>(
      std::count_if(kMapLayerNames.begin(), kMapLayerNames.end(), [&](const char* name) {
        return std::any_of(scene.layers.begin(), scene.layers.end(),
                           [&](const SceneLayer& layer) { return layer.element == name; });
      }));
}

void putLayers(const Scene& scene, VoxelMap& map) {
  for (const SceneLayer& row : scene.layers) {
    auto layer = std::find_if(map.layers.begin(), map.layers.end(),
                              [&](const MapLayer& l) { return l.name == row.element; });
    if (layer == map.layers.end()) {
      map.layers.push_back({row.element, std::vector<double>(map.cells.size(), 0.0)});
      layer = map.layers.end() - 1;
    }
    forEachCell(map.shape, cellsCentredIn(map, {row.min, row.max}),
                [&](CellIndex i) { layer->values[at(i)] = row.value; });
  }
}

/// Each cell owns its lower faces, so what lies on an upper wall is in no cell.
void putRewards(const Scene& scene, std::string_view text, VoxelMap& map) {
  for (std::size_t i = 0; i < scene.rewards.size(); ++i) {
    const Eigen::Vector3d& p = scene.rewards[i].position;
    if ((p.array() >= scene.max.array()).any()) {
      failAt(text, map.file,
             {.key = "rewards[" + std::to_string(i) + "].position_m",
              .problem = "is " + tomlText(p) + ", on a wall and so in no cell",
              .allowed = "below max_m " + tomlText(scene.max) + " of the room"});
    }
    if (map.indexAt(p) != kNoCell) map.rewards.push_back(scene.rewards[i]);
  }
}

/// Whether the walls of the room are where the map ends; floor and ceiling do not count in a plane.
bool wholeRoom(const Scene& scene, const VoxelMap& map) {
  const double near = kShrink * map.resolution;
  const Bounds kept = planning::boundsOf(map);
  for (int i = 0; i < 3; ++i) {
    if (i == 1 && map.shape.planar()) continue;
    if (kept.min[i] > scene.min[i] + near || kept.max[i] < scene.max[i] - near) return false;
  }
  return true;
}

}  // namespace

VoxelMap sceneMap(std::string_view text, const std::string& file, const LoadOptions& options) {
  const Scene scene = parseScene(text, file);
  checkLayers(scene, text, file);
  VoxelMap map = makeMap({.file = file,
                          .extent = {scene.min, scene.max},
                          .resolution = options.resolution.value_or(scene.resolution),
                          .bytes_per_cell = std::size_t{1} + (hasSharp(scene) ? 1 : 0) +
                                            layerCount(scene) * sizeof(double)},
                         options);
  map.name = scene.name;
  map.solid_border = wholeRoom(scene, map);
  markOutside(map, {scene.min, scene.max}, CellState::kOccupied);
  for (const Box& box : scene.boxes) markBox(map, box);
  for (const Prism& prism : scene.prisms) markPrism(map, prism);
  map.reel = scene.reel;
  map.start = scene.start;
  putRewards(scene, text, map);
  putLayers(scene, map);
  return map;
}

}  // namespace tautline::planning
