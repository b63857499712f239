#pragma once

/// @file
/// Where a sweeping string comes near what it could meet: a cheap test before the detailed ones. It
/// is exact in that nothing within kMargin of the string is ever missed; it may call more of the
/// string near than is. Lengths in cells. Not real-time safe: offline only.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planning_offline/map/voxel_map.h"

namespace tautline::planning {

/// Parts of a string's free length, 0 at its anchor and 1 at its end; from the end to the anchor,
/// without overlap. If there are too many, neighbours are joined.
class Stretches {
 public:
  struct Stretch {
    double low;
    double high;
  };

  /// One that lies nearer to the anchor than all before it, or ends where the last one begins.
  void add(double low, double high) noexcept {
    if (size_ > 0 && (size_ == kMost || list_[size_ - 1].low <= high)) {
      list_[size_ - 1].low = low;
    } else {
      list_[size_++] = {low, high};
    }
  }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] const Stretch* begin() const noexcept { return list_.data(); }
  [[nodiscard]] const Stretch* end() const noexcept { return list_.data() + size_; }

 private:
  static constexpr std::size_t kMost = 8;
  std::array<Stretch, kMost> list_;
  std::size_t size_{0};
};

/// Distances from the map's convex edges and from its occupied cells, a byte a cell each, in the
/// maximum norm. Edges and cells have whole coordinates: two of them that do not touch are at least
/// 1 apart, so the cells counted to the nearest one that touches a feature are no more than the
/// distance from it.
class NearField {
 public:
  static constexpr double kMargin = 1e-3;

  /// One byte a cell, not 0 if the cell touches a feature, be it in a corner only. Features are
  /// within the grid, and every edge belongs to an occupied cell.
  NearField(const GridShape& shape, const std::vector<std::uint8_t>& touching_edges,
            const std::vector<std::uint8_t>& touching_occupied);

  /// Lower bounds of the distances from the nearest feature; at most kFarthest.
  struct Distance {
    std::uint8_t edges;
    std::uint8_t occupied;
  };
  static constexpr std::uint8_t kFarthest = 255;
  /// At a point, which may be outside the grid.
  [[nodiscard]] Distance distance(const Eigen::Vector3d& p) const noexcept {
    return cells_[static_cast<std::size_t>(
        (within(p.z(), shape_.nz) * shape_.ny + within(p.y(), shape_.ny)) * shape_.nx +
        within(p.x(), shape_.nx))];
  }

  struct Near {
    Stretches edges;
    Stretches occupied;
  };
  /// Where the free part of a string from the anchor c comes nearer than kMargin to edges and to
  /// occupied cells while its end goes straight from p to q. With p = q: the segment from c to p.
  [[nodiscard]] Near near(const Eigen::Vector3d& c, const Eigen::Vector3d& p,
                          const Eigen::Vector3d& q) const noexcept;

 private:
  /// Coordinate of the cell; of the nearest one for points outside, which are no nearer.
  [[nodiscard]] static int within(double x, int cells) noexcept {
    return std::clamp(static_cast<int>(x), 0, cells - 1);
  }

  GridShape shape_;
  std::vector<Distance> cells_;
};

}  // namespace tautline::planning
