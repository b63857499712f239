#include "app/station/fence_scene.h"

#include <string>

#include "common/error.h"

namespace tautline {
namespace {

InputError tooLarge(const Scene& scene, const std::string& what, std::size_t room) {
  return InputError({.problem = "scene '" + scene.name + "': " + what + " for the fence",
                     .allowed = "at most " + std::to_string(room),
                     .remedy = "simplify the scene"});
}

void add(FenceObstacles& out, const Scene& scene, const FenceObstacle& obstacle) {
  if (!out.add(obstacle)) throw tooLarge(scene, "too many obstacles", out.kCapacity);
}

}  // namespace

FenceObstacles fenceObstaclesOf(const Scene& world) {
  FenceObstacles out;
  for (const Box& box : world.boxes) {
    FenceObstacle obstacle{.bottom_m = box.min.y(), .top_m = box.max.y()};
    const Eigen::Vector2d lo = floorPoint(box.min);
    const Eigen::Vector2d hi = floorPoint(box.max);
    obstacle.footprint_zx_m.add(lo);
    obstacle.footprint_zx_m.add({hi.x(), lo.y()});
    obstacle.footprint_zx_m.add(hi);
    obstacle.footprint_zx_m.add({lo.x(), hi.y()});
    add(out, world, obstacle);
  }
  for (const Prism& prism : world.prisms) {
    FenceObstacle obstacle{.bottom_m = prism.y_min, .top_m = prism.y_max};
    for (const Eigen::Vector2d& corner : prism.footprint) {
      if (!obstacle.footprint_zx_m.add(corner)) {
        throw tooLarge(world, "obstacle '" + prism.name + "' has too many corners",
                       obstacle.footprint_zx_m.kCapacity);
      }
    }
    add(out, world, obstacle);
  }
  return out;
}

}  // namespace tautline
