#include "planning_offline/field/line_of_sight.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "common/error.h"

namespace tautline::planning {
namespace {

constexpr std::int64_t kUnits = 65536;  // of a cell
constexpr double kLargest = 16384.0;    // cells: products of two lengths fit 63 bits
static_assert(kLargest == kSightFarthest);
static_assert(kSightUnit * static_cast<double>(kUnits) == 1.0);

/// One axis of the walk. Lengths in units.
struct Axis {
  std::int64_t length{0};     // of the line's shadow on this axis
  std::int64_t to_plane{0};   // from its start to the first plane between cells ahead, > 0
  std::int64_t crossings{0};  // planes strictly inside the line
  int cell{0};                // that the line starts in or enters first
  int sign{1};
  bool in_plane{false};  // lies between two layers of cells, `cell` and the one below it
  bool inside{false};    // of the grid
};

Axis axisOf(double from, double to, int cells) noexcept {
  TAUTLINE_CHECK(std::abs(from) <= kLargest && std::abs(to) <= kLargest);
  const std::int64_t p = std::llround(from * static_cast<double>(kUnits));
  const std::int64_t q = std::llround(to * static_cast<double>(kUnits));
  const std::int64_t below = p >= 0 ? p / kUnits : -((kUnits - 1 - p) / kUnits);  // floor
  const bool on_plane = below * kUnits == p;
  Axis axis;
  axis.length = std::abs(q - p);
  axis.sign = q < p ? -1 : 1;
  axis.in_plane = on_plane && p == q;
  axis.cell = static_cast<int>(q < p && on_plane ? below - 1 : below);
  axis.to_plane = q < p ? p - axis.cell * kUnits : (axis.cell + 1) * kUnits - p;
  const std::int64_t beyond = axis.length - axis.to_plane;
  axis.crossings = beyond > 0 ? (beyond + kUnits - 1) / kUnits : 0;
  const std::int64_t end = cells * kUnits;
  axis.inside = p >= 0 && p <= end && q >= 0 && q <= end;
  return axis;
}

/// Of any cell; there is nothing outside the grid.
bool blockedIn(const GridShape& shape, std::span<const std::uint8_t> blocked,
               const Eigen::Vector3i& cell) noexcept {
  return shape.contains(cell) && blocked[static_cast<std::size_t>(shape.index(cell))] != 0;
}

/// Which of two axes meets its next plane first: negative the first, zero both at once.
std::int64_t order(const Axis& a, const Axis& b) noexcept {
  return a.to_plane * b.length - b.to_plane * a.length;
}

/// True if blockedAt(index or cell) is false all along the line. kInside: cells by their index, for
/// a line that stays on the grid.
template <bool kInside, class BlockedAt>
bool walk(const GridShape& shape, const Axis& x, const Axis& y, const Axis& z,
          const BlockedAt& blockedAt) noexcept {
  std::int64_t xy = order(x, y);
  std::int64_t xz = order(x, z);
  std::int64_t yz = order(y, z);
  const std::int64_t lx = x.length * kUnits;
  const std::int64_t ly = y.length * kUnits;
  const std::int64_t lz = z.length * kUnits;
  std::int64_t left = x.crossings + y.crossings + z.crossings;
  // Without branches: the walk's turns cannot be foretold, its being blocked can.
  if constexpr (kInside) {
    const std::int64_t step_x = x.sign;
    const std::int64_t step_y = std::int64_t{y.sign} * shape.nx;
    const std::int64_t step_z = std::int64_t{z.sign} * shape.nx * shape.ny;
    std::int64_t i = shape.index({x.cell, y.cell, z.cell});
    while (!blockedAt(i)) {
      if (left <= 0) return true;
      const std::int64_t on_x = -std::int64_t{(xy <= 0) & (xz <= 0)};
      const std::int64_t on_y = -std::int64_t{(xy >= 0) & (yz <= 0)};
      const std::int64_t on_z = -std::int64_t{(xz >= 0) & (yz >= 0)};
      xy += (on_x & ly) - (on_y & lx);
      xz += (on_x & lz) - (on_z & lx);
      yz += (on_y & lz) - (on_z & ly);
      i += (on_x & step_x) + (on_y & step_y) + (on_z & step_z);
      left += on_x + on_y + on_z;
    }
    return false;
  } else {
    Eigen::Vector3i cell(x.cell, y.cell, z.cell);
    while (!blockedAt(cell)) {
      if (left <= 0) return true;
      const bool on_x = xy <= 0 && xz <= 0;
      const bool on_y = xy >= 0 && yz <= 0;
      const bool on_z = xz >= 0 && yz >= 0;
      xy += (on_x ? ly : 0) - (on_y ? lx : 0);
      xz += (on_x ? lz : 0) - (on_z ? lx : 0);
      yz += (on_y ? lz : 0) - (on_z ? ly : 0);
      cell += Eigen::Vector3i(on_x ? x.sign : 0, on_y ? y.sign : 0, on_z ? z.sign : 0);
      left -= int{on_x} + int{on_y} + int{on_z};
    }
    return false;
  }
}

}  // namespace

bool lineOfSight(const GridShape& shape, std::span<const std::uint8_t> blocked,
                 const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept {
  const Axis x = axisOf(a.x(), b.x(), shape.nx);
  const Axis y = axisOf(a.y(), b.y(), shape.ny);
  const Axis z = axisOf(a.z(), b.z(), shape.nz);
  if (x.in_plane || y.in_plane || z.in_plane) return true;
  if (x.inside && y.inside && z.inside) {
    return walk<true>(shape, x, y, z, [at = blocked.data()](std::int64_t i) { return at[i] != 0; });
  }
  return walk<false>(shape, x, y, z,
                     [&](const Eigen::Vector3i& cell) { return blockedIn(shape, blocked, cell); });
}

bool outsideSolids(const GridShape& shape, std::span<const std::uint8_t> blocked,
                   const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept {
  const Axis x = axisOf(a.x(), b.x(), shape.nx);
  const Axis y = axisOf(a.y(), b.y(), shape.ny);
  const Axis z = axisOf(a.z(), b.z(), shape.nz);
  // Between layers a place is inside a solid where the cells on all sides of it are.
  const Eigen::Vector3i below(int{x.in_plane}, int{y.in_plane}, int{z.in_plane});
  return walk<false>(shape, x, y, z, [&](const Eigen::Vector3i& cell) {
    for (int dz = 0; dz <= below.z(); ++dz) {
      for (int dy = 0; dy <= below.y(); ++dy) {
        for (int dx = 0; dx <= below.x(); ++dx) {
          if (!blockedIn(shape, blocked, cell - Eigen::Vector3i(dx, dy, dz))) return false;
        }
      }
    }
    return true;
  });
}

void needSightSize(const VoxelMap& map) {
  const GridShape& shape = map.shape;
  if (std::max({shape.nx, shape.ny, shape.nz}) <= static_cast<int>(kSightFarthest)) return;
  throw InputError(
      {.file = map.file,
       .problem = fmt::format("is {} x {} x {} cells", shape.nx, shape.ny, shape.nz),
       .allowed = fmt::format("at most {:g} along an axis for lines of sight", kSightFarthest),
       .remedy = "a larger --resolution, or a --crop"});
}

}  // namespace tautline::planning
