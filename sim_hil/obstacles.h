#pragma once

/// @file
/// The scene as the plant touches it: floor, room and upright convex prisms (boxes are prisms with
/// four corners, other footprints are cut into convex pieces). Finds where a straight piece of
/// tether touches a solid: always on a face or on an edge, with the direction that separates the
/// two by the shortest way (separating-axis test). World frame W, metres.

#include <array>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/mission/scene.h"

namespace tautline::sim {

inline constexpr int kMaxPrismCorners = 16;
inline constexpr int kMaxSolids = 512;

/// Upright prism over a convex polygon. `corner` is (z, x), counter-clockwise seen from above, so
/// that the outward normal of the side from corner i to i+1 is (dx, -dz) in (z, x). A side that
/// only exists because a concave footprint was cut is `inner`: nothing can touch it.
struct ConvexPrism {
  int corner_count{0};
  std::array<Eigen::Vector2d, kMaxPrismCorners> corner{};
  std::array<Eigen::Vector2d, kMaxPrismCorners> normal{};  ///< Outward, unit, (z, x).
  std::array<double, kMaxPrismCorners> offset{};           ///< normal . corner
  std::array<bool, kMaxPrismCorners> inner{};              ///< Side i to i+1 is a cut.
  double y_min{0.0};
  double y_max{0.0};
  int obstacle{0};  ///< Index of the scene's box or prism that this is a piece of.
};

/// An edge of a prism.
struct SolidEdge {
  Eigen::Vector3d start{Eigen::Vector3d::Zero()};
  Eigen::Vector3d direction{Eigen::Vector3d::UnitY()};  ///< Unit.
  double length{0.0};
  Eigen::Vector3d outward{
      Eigen::Vector3d::UnitX()};  ///< Between the normals of its two faces, unit.
};

/// A point of the segment p0 + s (p1 - p0) that touches a solid. The half-space rule
/// normal . p(s) >= offset keeps the segment out.
struct SegmentContact {
  double s{0.0};  ///< In [0, 1].
  Eigen::Vector3d normal{Eigen::Vector3d::UnitY()};
  double offset{0.0};
  int feature{0};  ///< Which face or, from kFirstEdge on, which edge of the prism.
};

inline constexpr int kMaxSegmentContacts = 4;
inline constexpr int kFirstEdge = 100;

/// `feature` is an edge of the prism. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] SolidEdge edgeOf(const ConvexPrism& prism, int feature) noexcept;

/// Contacts of the segment with the prism that overlap it or are nearer than `margin` [m]. Returns
/// how many were written to `out`. Real-time safe: no allocation, no locks, no exceptions.
int segmentContacts(const ConvexPrism& prism, const Eigen::Vector3d& p0, const Eigen::Vector3d& p1,
                    double margin, std::span<SegmentContact, kMaxSegmentContacts> out) noexcept;

/// Distance from a point to the prism [m], negative inside. Real-time safe: no allocation, no
/// locks, no exceptions.
[[nodiscard]] double signedDistance(const ConvexPrism& prism, const Eigen::Vector3d& p) noexcept;

struct Aabb {
  Eigen::Vector3d min{Eigen::Vector3d::Constant(std::numeric_limits<double>::max())};
  Eigen::Vector3d max{Eigen::Vector3d::Constant(std::numeric_limits<double>::lowest())};

  void include(const Eigen::Vector3d& p) noexcept {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  [[nodiscard]] bool overlaps(const Aabb& other, double margin) const noexcept {
    return (min.array() <= other.max.array() + margin).all() &&
           (max.array() >= other.min.array() - margin).all();
  }
};

/// All that can be touched. Immutable after construction.
class Obstacles {
 public:
  Obstacles() = default;

  /// Throws InputError if a footprint has too many corners or there are too many solids. Not
  /// real-time safe: start-up only.
  explicit Obstacles(const Scene& world);

  [[nodiscard]] std::span<const ConvexPrism> solids() const noexcept { return solids_; }
  [[nodiscard]] const Aabb& bounds(std::size_t solid) const noexcept { return bounds_[solid]; }
  [[nodiscard]] double floor() const noexcept { return floor_; }
  [[nodiscard]] bool hasRoom() const noexcept { return has_room_; }
  [[nodiscard]] const Aabb& room() const noexcept { return room_; }

  /// Height of what would carry a vehicle at p: the floor, or the highest solid below p.
  [[nodiscard]] double groundBelow(const Eigen::Vector3d& p) const noexcept;

  /// True if a ball round p overlaps a solid that is not wholly lower than `foot` below p: what a
  /// vehicle with that undercarriage lands on, it does not touch.
  [[nodiscard]] bool touches(const Eigen::Vector3d& p, double radius, double foot) const noexcept;

  /// Distance to the nearest solid [m], the largest double without solids. Walls of the room count
  /// if `with_room`.
  [[nodiscard]] double clearance(const Eigen::Vector3d& p, bool with_room) const noexcept;

  /// How much surfaces stand round p: the sum over the six directions of the axes of exp(-d/decay),
  /// d [m] the distance to the nearest surface on that side: 0 in the open, 1 at a wall, more in a
  /// corner or a shaft, 6 in a cell. Floor and room count.
  [[nodiscard]] double confinement(const Eigen::Vector3d& p, double decay) const noexcept;

 private:
  void addPrism(const Prism& prism, int obstacle);

  std::vector<ConvexPrism> solids_;
  std::vector<Aabb> bounds_;
  double floor_{-1.0};
  bool has_room_{false};
  Aabb room_;
};

}  // namespace tautline::sim
