#pragma once

/// @file
/// The edges of a map's obstacles that a string can bend round. Not real-time safe: offline only.
///
/// An edge runs along an axis w of the grid through the grid point (u, v) of the plane across it;
/// (u, v, w) are right-handed, so for w = y they are z and x. Of the four cells round it the one in
/// quadrant 0 … 3 is occupied and both its neighbours across u and v are free: bit 0 of the
/// quadrant is set if that cell lies above the edge along u, bit 1 along v. Lengths in cells.

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// The two axes across an axis of M, right-handed with it.
[[nodiscard]] constexpr int axisU(int w) noexcept { return (w + 1) % 3; }
[[nodiscard]] constexpr int axisV(int w) noexcept { return (w + 2) % 3; }

/// A point seen along an axis: (u, v).
[[nodiscard]] inline Eigen::Vector2d across(int axis, const Eigen::Vector3d& p) noexcept {
  return {p[axisU(axis)], p[axisV(axis)]};
}

/// A line of edges with the obstacle in the same quadrant.
struct ConvexEdge {
  int axis{0};
  int u{0};  ///< Grid point across the axis; coordinate 0 is the map's lower face.
  int v{0};
  int quadrant{0};

  /// −1 or +1: to which side of the edge the obstacle lies.
  [[nodiscard]] int sideU() const noexcept { return (quadrant & 1) != 0 ? 1 : -1; }
  [[nodiscard]] int sideV() const noexcept { return (quadrant & 2) != 0 ? 1 : -1; }

  [[nodiscard]] std::uint64_t packed() const noexcept {
    return static_cast<std::uint64_t>(axis) << 60U | static_cast<std::uint64_t>(quadrant) << 56U |
           static_cast<std::uint64_t>(u) << 28U | static_cast<std::uint64_t>(v);
  }
  [[nodiscard]] static ConvexEdge unpacked(std::uint64_t packed) noexcept {
    constexpr std::uint64_t kGrid = (std::uint64_t{1} << 28U) - 1U;
    return {static_cast<int>(packed >> 60U), static_cast<int>(packed >> 28U & kGrid),
            static_cast<int>(packed & kGrid), static_cast<int>(packed >> 56U & 3U)};
  }
};

/// Which edges of one axis are convex: a byte a unit edge.
class ConvexEdges {
 public:
  /// Every side of the map must have less than 2^28 cells.
  ConvexEdges(const VoxelMap& map, int axis);

  [[nodiscard]] int axis() const noexcept { return axis_; }
  [[nodiscard]] int sizeU() const noexcept { return size_u_; }  ///< Cells along u.
  [[nodiscard]] int sizeV() const noexcept { return size_v_; }
  [[nodiscard]] int sizeW() const noexcept { return size_w_; }

  /// Quadrants in which there is a convex edge from w to w + 1, as a bit mask; 0 <= u <= sizeU(),
  /// 0 <= v <= sizeV(), 0 <= w < sizeW().
  [[nodiscard]] unsigned quadrants(int u, int v, int w) const noexcept {
    return masks_[index(u, v, w)] & 0xFU;
  }

  /// Quadrants with a convex edge if of the slabs w − 1 and w only that is solid which is occupied
  /// in both: the edges of a joint between them (shrunk_solid.h). Domain as above.
  [[nodiscard]] unsigned joints(int u, int v, int w) const noexcept {
    return masks_[index(u, v, w)] >> 4U;
  }

 private:
  [[nodiscard]] std::size_t index(int u, int v, int w) const noexcept {
    return (static_cast<std::size_t>(w) * static_cast<std::size_t>(size_v_ + 1) +
            static_cast<std::size_t>(v)) *
               static_cast<std::size_t>(size_u_ + 1) +
           static_cast<std::size_t>(u);
  }

  int axis_;
  int size_u_;
  int size_v_;
  int size_w_;
  std::vector<std::uint8_t> masks_;  ///< quadrants() in the lower half, joints() in the upper.
};

}  // namespace tautline::planning
