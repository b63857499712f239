#pragma once

/// @file
/// Hard limits of the tether, and whether a state is within them. Points in M [m]. Not real-time
/// safe: offline only.

#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "common/fields.h"

namespace tautline::planning {

/// Of the straight line from the anchor to a position, above the horizontal [rad]; 0 if they are
/// one place.
[[nodiscard]] inline double elevationOf(const Eigen::Vector3d& anchor,
                                        const Eigen::Vector3d& position) {
  const Eigen::Vector3d d = position - anchor;
  return std::atan2(d.y(), std::hypot(d.x(), d.z()));
}

/// Hard gates of the tether. The planners that know the tether never go beyond them; a path that
/// does has risk 1. The map has one more: cells that the tether must not touch
/// (VoxelMap::no_contact).
struct TetherLimits {
  double length_max{0.0};
  int contacts_max{-1};
  double elevation_min{-90.0};

  /// Whether so much taut tether [m] is within the limit, up to rounding.
  [[nodiscard]] bool allowsLength(double length) const noexcept {
    constexpr double kSlack = 1e-9;
    return length_max <= 0.0 || length <= length_max + kSlack;
  }
  [[nodiscard]] bool allowsContacts(int contacts) const noexcept {
    return contacts_max < 0 || contacts <= contacts_max;
  }
  /// Whether the vehicle at `position` is high enough, seen from the active anchor. At the anchor
  /// itself it is.
  [[nodiscard]] bool allowsElevation(const Eigen::Vector3d& anchor,
                                     const Eigen::Vector3d& position) const noexcept {
    return elevation_min <= -90.0 || position == anchor ||
           elevationOf(anchor, position) >= elevation_min * std::numbers::pi / 180.0;
  }

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_max_m", length_max, Range{0.0, 1000.0}, "tether on the reel; 0 = no limit");
    v.field("contacts_max", contacts_max, Range{-1, 64}, "-1 = no limit");
    v.field("elevation_min_deg", elevation_min, Range{-90.0, 90.0},
            "of the vehicle seen from the active anchor");
  }
};

}  // namespace tautline::planning
