#pragma once

/// @file
/// Where the drone may be: tether length, height, elevation cone, keep-out boxes, and the distance
/// to the map's obstacles. Positions are in W (docs/notation.md).

#include <cstddef>

#include <Eigen/Core>

#include "common/error.h"
#include "common/fields.h"
#include "common/fixed_list.h"
#include "common/prism.h"
#include "supervision/detect/findings.h"

namespace tautline {

/// Axis-aligned box that the drone must stay out of.
struct KeepOut {
  Eigen::Vector3d min_m{Eigen::Vector3d::Zero()};
  Eigen::Vector3d max_m{Eigen::Vector3d::Zero()};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("min_m", min_m, Range{-1000, 1000}, "lower corner in W");
    v.field("max_m", max_m, Range{-1000, 1000}, "upper corner in W");
  }
  /// Throws InputError.
  void validate() const {
    if ((min_m.array() < max_m.array()).all()) return;
    throw InputError({.key = "max_m", .problem = "is not above min_m in every component"});
  }
};

/// Obstacle of the map: upright prism over a polygon.
struct FenceObstacle {
  FixedList<Eigen::Vector2d, 32> footprint_zx_m{};
  double bottom_m{0.0};
  double top_m{1.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("footprint_zx_m", footprint_zx_m, Range{-1000, 1000}, "corners (z, x) in W, in order");
    v.field("bottom_m", bottom_m, Range{-1000, 1000}, "height of its lower face in W");
    v.field("top_m", top_m, Range{-1000, 1000}, "height of its upper face in W");
  }
  /// Throws InputError.
  void validate() const {
    if (footprint_zx_m.all().size() < 3)
      throw InputError({.key = "footprint_zx_m", .problem = "has fewer than three corners"});
    if (bottom_m >= top_m) throw InputError({.key = "top_m", .problem = "is not above bottom_m"});
  }
  [[nodiscard]] PrismView view() const noexcept { return {footprint_zx_m.all(), bottom_m, top_m}; }
};
inline constexpr std::size_t kMaxFenceObstacles = 64;
using FenceObstacles = FixedList<FenceObstacle, kMaxFenceObstacles>;

struct FenceConfig {
  double max_length_m{10.0};
  double min_height_m{-3.0};
  double max_height_m{5.0};
  double min_elevation_rad{-1.571};
  double max_elevation_rad{1.571};
  double min_clearance_m{0.2};
  FixedList<KeepOut, 16> keep_out;
  FenceObstacles obstacles;

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("max_length_m", max_length_m, Range{0.5, 1000}, "total tether out");
    v.field("min_height_m", min_height_m, Range{-1000, 1000}, "above the reel outlet");
    v.field("max_height_m", max_height_m, Range{-1000, 1000}, "above the reel outlet");
    v.field("min_elevation_rad", min_elevation_rad, Range{-1.571, 1.571},
            "of the drone above the reel outlet");
    v.field("max_elevation_rad", max_elevation_rad, Range{-1.571, 1.571},
            "of the drone above the reel outlet");
    v.field("min_clearance_m", min_clearance_m, Range{0, 100},
            "between the tether's attachment and the obstacles of the map");
    v.rows("keep_out", keep_out, "boxes to stay out of");
    v.rows("obstacles", obstacles, "of the map; a scene replaces them");
  }
  /// Throws InputError for what a single range cannot say.
  void validate() const {
    if (min_height_m >= max_height_m)
      throw InputError({.key = "max_height_m", .problem = "is not above min_height_m"});
    if (min_elevation_rad >= max_elevation_rad)
      throw InputError({.key = "max_elevation_rad", .problem = "is not above min_elevation_rad"});
  }
};

struct FenceInput {
  bool flying{false};   ///< On the ground only length, height and keep-out boxes count.
  double L_total{0.0};  ///< Sensed [m].
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};
};

/// Distance from a point to the nearest obstacle [m], negative inside; the largest finite double
/// without obstacles. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] double clearance(const Eigen::Vector3d& p_W,
                               const FenceObstacles& obstacles) noexcept;

/// kFenceLength, kFenceAltitude, kFenceElevation, kFenceKeepOut, kFenceClearance. Real-time safe:
/// no allocation, no locks, no exceptions; work is bounded by the rooms of the lists.
class Fence {
 public:
  /// Keeps a reference: the lists are large.
  explicit Fence(const FenceConfig& config) noexcept : config_(config) {}

  void update(const FenceInput& in, Findings& out) const noexcept;

 private:
  const FenceConfig& config_;
};

}  // namespace tautline
