#include "planning_offline/tether/obstacle_confined.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "planning_offline/tether/convex_edges.h"

namespace tautline::planning {
namespace {

constexpr double kTouching = 1e-9;  // overlap that is rounding [cells]

/// Whether triangle and square overlap, by separating axes: the square's sides and the normals of
/// the triangle's. `half`: of the square's side; 0 asks for a point inside the triangle.
bool overlap(const std::array<Eigen::Vector2d, 3>& triangle, const Eigen::Vector2d& centre,
             double half) {
  const auto apart = [&](const Eigen::Vector2d& axis) {
    const double size = axis.cwiseAbs().sum();
    if (size < kTouching) return false;  // of two corners in one place
    const auto [low, high] =
        std::minmax({axis.dot(triangle[0]), axis.dot(triangle[1]), axis.dot(triangle[2])});
    const double middle = axis.dot(centre);
    const double reach = (half - kTouching) * size;
    return low >= middle + reach || high <= middle - reach;
  };
  if (apart(Eigen::Vector2d::UnitX()) || apart(Eigen::Vector2d::UnitY())) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector2d side = triangle[(i + 1) % 3] - triangle[i];
    if (apart({-side.y(), side.x()})) return false;
  }
  return true;
}

bool cellConfined(const Eigen::Vector3i& cell, const std::array<Eigen::Vector3d, 3>& triangle,
                  double half) {
  const Eigen::Vector3d centre = cell.cast<double>().array() + 0.5;
  for (int axis = 0; axis < 3; ++axis) {
    if (!overlap({across(axis, triangle[0]), across(axis, triangle[1]), across(axis, triangle[2])},
                 across(axis, centre), half))
      return false;
  }
  return true;
}

}  // namespace

bool obstacleConfined(const VoxelMap& map, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c, Confinement reading) {
  const double half = reading == Confinement::kTouching ? 0.5 : 0.0;
  const Eigen::Array3d last(map.shape.nx - 1, map.shape.ny - 1, map.shape.nz - 1);
  const auto cellOf = [&](const Eigen::Vector3d& p) -> Eigen::Vector3i {
    return p.array().floor().max(0.0).min(last).cast<int>();
  };
  const Eigen::Vector3i low = cellOf(a.cwiseMin(b).cwiseMin(c));
  const Eigen::Vector3i high = cellOf(a.cwiseMax(b).cwiseMax(c));
  Eigen::Vector3i cell;
  for (cell.z() = low.z(); cell.z() <= high.z(); ++cell.z()) {
    for (cell.y() = low.y(); cell.y() <= high.y(); ++cell.y()) {
      for (cell.x() = low.x(); cell.x() <= high.x(); ++cell.x()) {
        const auto i = static_cast<std::size_t>(map.shape.index(cell));
        if (map.cells[i] == CellState::kOccupied && cellConfined(cell, {a, b, c}, half))
          return true;
      }
    }
  }
  return false;
}

}  // namespace tautline::planning
