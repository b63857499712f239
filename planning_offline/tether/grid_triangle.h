#pragma once

/// @file
/// Grid points in a triangle of the plane, row by row: what a sweeping string may meet. Not
/// real-time safe: offline only.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Core>

namespace tautline::planning {

/// A triangle cut by lines across its longer side of the bounding box.
class TriangleRows {
 public:
  TriangleRows(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c)
      : corner_{a, b, c} {
    const Eigen::Vector2d extent = a.cwiseMax(b).cwiseMax(c) - a.cwiseMin(b).cwiseMin(c);
    along_ = extent.x() >= extent.y() ? 0 : 1;
    std::sort(corner_.begin(), corner_.end(),
              [this](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
                return p[along_] < q[along_];
              });
  }

  /// The component that numbers the rows: 0 or 1.
  [[nodiscard]] int along() const noexcept { return along_; }
  [[nodiscard]] double first() const noexcept { return corner_[0][along_]; }
  [[nodiscard]] double last() const noexcept { return corner_[2][along_]; }

  /// Extent of the rows from `row - margin` to `row + margin`, as lowest and highest.
  [[nodiscard]] std::pair<double, double> extent(double row, double margin) const noexcept {
    const double lower = std::clamp(row - margin, first(), last());
    const double upper = std::clamp(row + margin, first(), last());
    std::pair<double, double> range = cut(lower);
    const std::pair<double, double> other = cut(upper);
    range.first = std::min(range.first, other.first);
    range.second = std::max(range.second, other.second);
    const double middle = corner_[1][along_];
    if (lower <= middle && middle <= upper) {
      range.first = std::min(range.first, corner_[1][1 - along_]);
      range.second = std::max(range.second, corner_[1][1 - along_]);
    }
    return range;
  }

 private:
  /// Where the side between two corners is at a row, for rows between them.
  [[nodiscard]] double side(std::size_t i, std::size_t j, double row) const noexcept {
    const double run = corner_[j][along_] - corner_[i][along_];
    const double part = run > 0.0 ? (row - corner_[i][along_]) / run : 0.0;
    return corner_[i][1 - along_] + part * (corner_[j][1 - along_] - corner_[i][1 - along_]);
  }
  [[nodiscard]] std::pair<double, double> cut(double row) const noexcept {
    const double a = side(0, 2, row);
    const double b = row < corner_[1][along_] ? side(0, 1, row) : side(1, 2, row);
    return std::minmax(a, b);
  }

  std::array<Eigen::Vector2d, 3> corner_;
  int along_;
};

/// Calls visit(u, v) for every grid point 0 <= u <= size_u, 0 <= v <= size_v in the triangle or
/// nearer to it than `margin`, and perhaps for some a little outside. In cells.
template <typename Visit>
void visitGridPoints(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                     int size_u, int size_v, double margin, Visit&& visit) {
  const TriangleRows rows(a, b, c);
  const bool along_u = rows.along() == 0;
  const int row_max = along_u ? size_u : size_v;
  const int column_max = along_u ? size_v : size_u;
  const auto from = [margin](double x) {
    return static_cast<int>(std::ceil(std::max(x - margin, 0.0)));
  };
  const auto until = [margin](double x, int most) {
    return static_cast<int>(std::floor(std::clamp(x + margin, -1.0, static_cast<double>(most))));
  };
  const int row_last = until(rows.last(), row_max);
  for (int row = from(std::min(rows.first(), row_max + 1.0)); row <= row_last; ++row) {
    const auto [low, high] = rows.extent(row, margin);
    const int last = until(high, column_max);
    for (int column = from(std::min(low, column_max + 1.0)); column <= last; ++column) {
      along_u ? visit(row, column) : visit(column, row);
    }
  }
}

/// The same for the part of the triangle c, c + p, c + q between the parallels to its side opposite
/// of c at the parts low < high of the way there. May visit a point twice.
template <typename Visit>
void visitGridPointsBetween(const Eigen::Vector2d& c, const Eigen::Vector2d& p,
                            const Eigen::Vector2d& q, double low, double high, int size_u,
                            int size_v, double margin, Visit&& visit) {
  const Eigen::Vector2d far_p = c + high * p;
  const Eigen::Vector2d far_q = c + high * q;
  if (low <= 0.0) {
    visitGridPoints(c, far_p, far_q, size_u, size_v, margin, visit);
    return;
  }
  const Eigen::Vector2d near_p = c + low * p;
  visitGridPoints(near_p, far_p, far_q, size_u, size_v, margin, visit);
  visitGridPoints(near_p, Eigen::Vector2d(c + low * q), far_q, size_u, size_v, margin, visit);
}

}  // namespace tautline::planning
