#pragma once

/// @file
/// A scene's obstacles for the fence: the map that the station watches its distance to.

#include "common/mission/scene.h"
#include "supervision/detect/fence.h"

namespace tautline {

/// @param world a scene in W (sceneInWorld()). @throws InputError if it has more obstacles, or one
/// with more corners, than the fence has room for. Not real-time safe: start-up only.
[[nodiscard]] FenceObstacles fenceObstaclesOf(const Scene& world);

}  // namespace tautline
