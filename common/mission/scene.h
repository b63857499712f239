#pragma once

/// @file
/// A hand-written scene: a room, its obstacles, where the reel stands and where the drone is parked
/// (`*.scene.toml`, docs/mission_files.md). Also the intersection of straight lines with its
/// obstacles, for mission check and simulator.
///
/// All points are metres in the map frame M: axes as the world frame W (y up), any origin. W has
/// its origin at the reel outlet: sceneInWorld() shifts a scene there. Not real-time safe: start-up
/// only.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "common/prism.h"

namespace tautline {

/// Axis-aligned solid box, min < max in every component.
struct Box {
  std::string name;
  Eigen::Vector3d min{Eigen::Vector3d::Zero()};
  Eigen::Vector3d max{Eigen::Vector3d::Zero()};
  bool sharp{false};  ///< The tether must not touch it; the planner plans so.
};

/// Solid upright prism over a simple polygon in the floor plane; corners are (z, x), any
/// orientation, not necessarily convex, not closed (the last corner differs from the first).
struct Prism {
  std::string name;
  std::vector<Eigen::Vector2d> footprint;
  double y_min{0.0};
  double y_max{0.0};
  bool sharp{false};  ///< As Box::sharp.
};

/// A position worth visiting, for planning.
struct Reward {
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};
  double value{0.0};
};

/// What a risk element reads where it depends on the surroundings (terrain, threat …): a value in
/// [0, 1] in a box of the room, for planning. Later rows hold where rows overlap.
struct SceneLayer {
  std::string element;  ///< Name of the risk element; the planner knows which there are.
  Eigen::Vector3d min{Eigen::Vector3d::Zero()};
  Eigen::Vector3d max{Eigen::Vector3d::Zero()};
  double value{0.0};
};

struct Scene {
  std::string name;
  std::uint64_t hash{0};  ///< FNV-1a of the file's bytes; a mission's map_hash refers to it.
  Eigen::Vector3d min{Eigen::Vector3d::Zero()};  ///< Lower corner of the room [m].
  Eigen::Vector3d max{Eigen::Vector3d::Zero()};  ///< Upper corner of the room [m].
  double floor{0.0};                             ///< Height of the floor [m].
  double resolution{0.1};  ///< Voxel size for grid maps made of this scene [m].
  std::vector<Box> boxes;
  std::vector<Prism> prisms;
  Eigen::Vector3d reel{Eigen::Vector3d::Zero()};  ///< The reel outlet.
  std::optional<Eigen::Vector3d> start;           ///< The drone's tether attachment when parked.
  std::vector<Reward> rewards;
  std::vector<SceneLayer> layers;
};

/// Strict reader: throws InputError with file, line and row. Checks that corners are ordered,
/// footprints are simple polygons, reel, start and rewards are in the room and outside every
/// obstacle, and layers are at least partly in the room.
[[nodiscard]] Scene readScene(const std::filesystem::path& path);

/// `name` stands for the file in errors.
[[nodiscard]] Scene parseScene(std::string_view text, const std::string& name);

/// What parseScene() reads back as the same scene, bit for bit but for the hash.
[[nodiscard]] std::string sceneText(const Scene& scene);

/// The same scene with the reel outlet as origin, so in W; its floor is then at floor - reel.y.
[[nodiscard]] Scene sceneInWorld(const Scene& scene);

/// First stretch of the line p-q in the interior of the obstacle, or nothing. Merely touching a
/// face or an edge is no hit.
[[nodiscard]] std::optional<SegmentHit> intersect(const Eigen::Vector3d& p,
                                                  const Eigen::Vector3d& q, const Box& box);
[[nodiscard]] std::optional<SegmentHit> intersect(const Eigen::Vector3d& p,
                                                  const Eigen::Vector3d& q, const Prism& prism);

/// First obstacle that the line p-q enters.
struct SceneHit {
  std::string obstacle;  ///< Its name.
  SegmentHit segment;
};
[[nodiscard]] std::optional<SceneHit> firstHit(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                                               const Scene& scene);

/// Distance from a point to the surface of the obstacle [m], negative inside.
[[nodiscard]] double signedDistance(const Eigen::Vector3d& p, const Box& box);
[[nodiscard]] double signedDistance(const Eigen::Vector3d& p, const Prism& prism);

/// Distance from a point to the nearest obstacle of the scene [m], negative inside one; walls,
/// floor and ceiling do not count. The largest finite double in a scene without obstacles.
[[nodiscard]] double clearance(const Eigen::Vector3d& p, const Scene& scene);

}  // namespace tautline
