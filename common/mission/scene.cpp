#include "common/mission/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "common/error.h"
#include "common/mission/mission_file.h"
#include "common/toml/toml_file.h"
#include "common/toml/toml_writer.h"

namespace tautline {
namespace {

constexpr int kSceneFileVersion = 1;
constexpr Range kCoordinate{-1000.0, 1000.0};

/// True if the closed segments a-b and c-d have a point in common.
bool segmentsMeet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                  const Eigen::Vector2d& d) {
  const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q,
                       const Eigen::Vector2d& r) {
    const double s = cross(q - p, r - p);
    return (s > 0.0) - (s < 0.0);
  };
  const auto within = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q,
                         const Eigen::Vector2d& r) {
    return r.x() >= std::min(p.x(), q.x()) && r.x() <= std::max(p.x(), q.x()) &&
           r.y() >= std::min(p.y(), q.y()) && r.y() <= std::max(p.y(), q.y());
  };
  const int c_side = side(a, b, c);
  const int d_side = side(a, b, d);
  const int a_side = side(c, d, a);
  const int b_side = side(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && within(a, b, c)) || (d_side == 0 && within(a, b, d)) ||
         (a_side == 0 && within(c, d, a)) || (b_side == 0 && within(c, d, b));
}

/// Edges that are not neighbours have no point in common, no edge is a point.
bool isSimplePolygon(const std::vector<Eigen::Vector2d>& polygon) {
  const std::size_t n = polygon.size();
  if (n < 3) return false;
  double area = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (polygon[i] == polygon[(i + 1) % n]) return false;
    area += cross(polygon[i], polygon[(i + 1) % n]);
    for (std::size_t j = i + 2; j < n; ++j) {
      if ((j + 1) % n == i) continue;
      if (segmentsMeet(polygon[i], polygon[(i + 1) % n], polygon[j], polygon[(j + 1) % n]))
        return false;
    }
  }
  return area != 0.0;
}

PrismView viewOf(const Prism& prism) { return {prism.footprint, prism.y_min, prism.y_max}; }

bool contains(const Scene& scene, const Eigen::Vector3d& p) {
  return (p.array() >= scene.min.array()).all() && (p.array() <= scene.max.array()).all();
}

void checkPlace(const TomlTable& table, const char* key, const Eigen::Vector3d& p,
                const Scene& scene) {
  if (!contains(scene, p)) {
    throw table.error(key, "is " + tomlText(p) + ", outside the room",
                      tomlText(scene.min) + " to " + tomlText(scene.max));
  }
  const auto check = [&](const auto& obstacles) {
    for (const auto& obstacle : obstacles) {
      if (signedDistance(p, obstacle) >= 0.0) continue;
      throw table.error(key, "is " + tomlText(p) + ", inside obstacle '" + obstacle.name + "'");
    }
  };
  check(scene.boxes);
  check(scene.prisms);
}

void readExtent(TomlTable& table, Eigen::Vector3d& min, Eigen::Vector3d& max) {
  table.require("min_m", min, kCoordinate);
  table.require("max_m", max, kCoordinate);
  if (!(min.array() < max.array()).all()) {
    throw table.error("max_m", "is " + tomlText(max),
                      "more than min_m " + tomlText(min) + " in every component");
  }
}

void readObstacles(TomlTable& root, Scene& scene) {
  for (TomlTable& table : root.tables("boxes")) {
    Box& box = scene.boxes.emplace_back();
    table.require("name", box.name);
    readExtent(table, box.min, box.max);
    table.read("sharp", box.sharp);
    table.finish();
  }
  for (TomlTable& table : root.tables("prisms")) {
    Prism& prism = scene.prisms.emplace_back();
    table.require("name", prism.name);
    table.require("footprint_m", prism.footprint, kCoordinate);
    table.require("y_min_m", prism.y_min, kCoordinate);
    table.require("y_max_m", prism.y_max, kCoordinate);
    table.read("sharp", prism.sharp);
    table.finish();
    if (!isSimplePolygon(prism.footprint)) {
      throw table.error("footprint_m", "is not a simple polygon",
                        "at least 3 corners [z, x], no edge crossing or touching another",
                        "do not repeat the first corner at the end");
    }
    if (prism.y_min >= prism.y_max) {
      throw table.error("y_max_m", "is " + tomlText(prism.y_max),
                        "more than y_min_m " + tomlText(prism.y_min));
    }
  }
}

void readLayers(TomlTable& root, Scene& scene) {
  for (TomlTable& table : root.tables("layers")) {
    SceneLayer& layer = scene.layers.emplace_back();
    table.require("element", layer.element);
    readExtent(table, layer.min, layer.max);
    table.require("value", layer.value, Range{0.0, 1.0});
    table.finish();
    if ((layer.max.array() <= scene.min.array()).any() ||
        (layer.min.array() >= scene.max.array()).any()) {
      throw table.error("min_m",
                        "to max_m is " + tomlText(layer.min) + " to " + tomlText(layer.max) +
                            ", outside the room",
                        tomlText(scene.min) + " to " + tomlText(scene.max));
    }
  }
}

Scene sceneFrom(const TomlFile& file) {
  TomlTable root = file.root();
  Scene scene;
  int version = 0;
  root.require("version", version, Range{kSceneFileVersion, kSceneFileVersion});
  root.require("name", scene.name);
  readExtent(root, scene.min, scene.max);
  root.read("floor_m", scene.floor, kCoordinate);
  root.read("resolution_m", scene.resolution, Range{0.001, 10.0});
  readObstacles(root, scene);
  root.require("reel_m", scene.reel, kCoordinate);
  checkPlace(root, "reel_m", scene.reel, scene);
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  if (root.read("start_m", start, kCoordinate)) {
    scene.start = start;
    checkPlace(root, "start_m", start, scene);
  }
  for (TomlTable& table : root.tables("rewards")) {
    Reward& reward = scene.rewards.emplace_back();
    table.require("position_m", reward.position, kCoordinate);
    table.require("value", reward.value, Range{0.0, 1e6});
    table.finish();
    checkPlace(table, "position_m", reward.position, scene);
  }
  readLayers(root, scene);
  root.finish();
  return scene;
}

}  // namespace

Scene readScene(const std::filesystem::path& path) {
  return parseScene(readTextFile(path), path.string());
}

Scene parseScene(std::string_view text, const std::string& name) {
  Scene scene = sceneFrom(TomlFile::parse(text, name));
  scene.hash = fnv1a(text);
  return scene;
}

std::string sceneText(const Scene& scene) {
  std::string text;
  const auto line = [&text](const char* key, const auto& value) {
    text += std::string(key) + " = " + tomlText(value) + '\n';
  };
  line("version", kSceneFileVersion);
  line("name", scene.name);
  line("min_m", scene.min);
  line("max_m", scene.max);
  line("floor_m", scene.floor);
  line("resolution_m", scene.resolution);
  line("reel_m", scene.reel);
  if (scene.start) line("start_m", *scene.start);
  for (const Reward& reward : scene.rewards) {
    text += "\n[[rewards]]\n";
    line("position_m", reward.position);
    line("value", reward.value);
  }
  for (const Box& box : scene.boxes) {
    text += "\n[[boxes]]\n";
    line("name", box.name);
    line("min_m", box.min);
    line("max_m", box.max);
    if (box.sharp) line("sharp", box.sharp);
  }
  for (const Prism& prism : scene.prisms) {
    text += "\n[[prisms]]\n";
    line("name", prism.name);
    line("footprint_m", std::span(prism.footprint));
    line("y_min_m", prism.y_min);
    line("y_max_m", prism.y_max);
    if (prism.sharp) line("sharp", prism.sharp);
  }
  for (const SceneLayer& layer : scene.layers) {
    text += "\n[[layers]]\n";
    line("element", layer.element);
    line("min_m", layer.min);
    line("max_m", layer.max);
    line("value", layer.value);
  }
  return text;
}

Scene sceneInWorld(const Scene& scene) {
  Scene world = scene;
  const Eigen::Vector3d shift = -scene.reel;
  world.min += shift;
  world.max += shift;
  world.floor += shift.y();
  for (Box& box : world.boxes) {
    box.min += shift;
    box.max += shift;
  }
  for (Prism& prism : world.prisms) {
    for (Eigen::Vector2d& corner : prism.footprint) corner += floorPoint(shift);
    prism.y_min += shift.y();
    prism.y_max += shift.y();
  }
  world.reel += shift;
  if (world.start) *world.start += shift;
  for (Reward& reward : world.rewards) reward.position += shift;
  for (SceneLayer& layer : world.layers) {
    layer.min += shift;
    layer.max += shift;
  }
  return world;
}

std::optional<SegmentHit> intersect(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                                    const Box& box) {
  SegmentHit hit{0.0, 1.0};
  for (int i = 0; i < 3; ++i) {
    if (!clip(p[i], q[i] - p[i], box.min[i], box.max[i], hit)) return std::nullopt;
  }
  return hit;
}

std::optional<SegmentHit> intersect(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                                    const Prism& prism) {
  return intersect(p, q, viewOf(prism));
}

std::optional<SceneHit> firstHit(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                                 const Scene& scene) {
  std::optional<SceneHit> first;
  const auto consider = [&](const auto& obstacles) {
    for (const auto& obstacle : obstacles) {
      const std::optional<SegmentHit> hit = intersect(p, q, obstacle);
      if (hit && (!first || hit->t_in < first->segment.t_in)) first = SceneHit{obstacle.name, *hit};
    }
  };
  consider(scene.boxes);
  consider(scene.prisms);
  return first;
}

double signedDistance(const Eigen::Vector3d& p, const Box& box) {
  const Eigen::Array3d outside = (box.min - p).array().max((p - box.max).array());
  return outside.max(0.0).matrix().norm() + std::min(outside.maxCoeff(), 0.0);
}

double signedDistance(const Eigen::Vector3d& p, const Prism& prism) {
  return signedDistance(p, viewOf(prism));
}

double clearance(const Eigen::Vector3d& p, const Scene& scene) {
  double nearest = std::numeric_limits<double>::max();
  for (const Box& box : scene.boxes) nearest = std::min(nearest, signedDistance(p, box));
  for (const Prism& prism : scene.prisms) nearest = std::min(nearest, signedDistance(p, prism));
  return nearest;
}

}  // namespace tautline
