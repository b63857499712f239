#include "planning_offline/tether/test/rubber_band.h"

#include <algorithm>

namespace tautline::planning {
namespace {

using Int = std::int64_t;
constexpr Int kCell = 1024;

BandPoint operator-(const BandPoint& a, const BandPoint& b) { return {a.u - b.u, a.v - b.v}; }
Int cross(const BandPoint& a, const BandPoint& b) { return a.u * b.v - a.v * b.u; }
Int dot(const BandPoint& a, const BandPoint& b) { return a.u * b.u + a.v * b.v; }
Int sign(Int x) { return (x > 0) - (x < 0); }

bool solid(const VoxelMap& map, Int u, Int v) {
  const Eigen::Vector3i cell(static_cast<int>(v), 0, static_cast<int>(u));
  return map.shape.contains(cell) &&
         map.cells[static_cast<std::size_t>(map.shape.index(cell))] == CellState::kOccupied;
}

/// A convex corner and the way into its material.
struct Corner {
  BandPoint at;
  BandPoint inward;
};

std::vector<Corner> convexCorners(const VoxelMap& map) {
  std::vector<Corner> corners;
  for (Int u = 0; u <= map.shape.nz; ++u) {
    for (Int v = 0; v <= map.shape.nx; ++v) {
      for (const Int du : {-1, 0}) {
        for (const Int dv : {-1, 0}) {
          if (!solid(map, u + du, v + dv)) continue;
          if (solid(map, u - 1 - du, v + dv) || solid(map, u + du, v - 1 - dv)) continue;
          corners.push_back({{u * kCell, v * kCell}, {2 * du + 1, 2 * dv + 1}});
        }
      }
    }
  }
  return corners;
}

/// Corners that hold the bend a-b-c back when it is pulled towards a-c.
std::vector<BandPoint> holding(const std::vector<Corner>& corners, const BandPoint& a,
                               const BandPoint& b, const BandPoint& c) {
  const Int s = sign(cross(b - a, c - b));
  std::vector<BandPoint> points;
  for (const Corner& corner : corners) {
    const Int from_ab = s * cross(b - a, corner.at - a);
    const Int from_bc = s * cross(c - b, corner.at - b);
    const Int from_ca = s * cross(a - c, corner.at - c);
    if (from_ab < 0 || from_bc < 0 || from_ca <= 0) continue;
    if (from_ab == 0 && s * cross(b - a, corner.inward) <= 0) continue;
    if (from_bc == 0 && s * cross(c - b, corner.inward) <= 0) continue;
    points.push_back(corner.at);
  }
  return points;
}

/// The hull of a, c and the points from a to c on the side of the bend, without both ends.
std::vector<BandPoint> hull(const BandPoint& a, const BandPoint& c, Int s,
                            const std::vector<BandPoint>& points) {
  std::vector<BandPoint> chain;
  BandPoint at = a;
  while (true) {
    BandPoint next = c;
    for (const BandPoint& p : points) {
      if (p == at) continue;
      const Int side = s * cross(next - at, p - at);
      // Nothing lies on the outer side of a hull's edge; of points in line the farthest.
      if (side < 0 || (side == 0 && dot(p - at, p - at) > dot(next - at, next - at))) next = p;
    }
    if (next == c) return chain;
    chain.push_back(next);
    at = next;
  }
}

}  // namespace

std::vector<BandPoint> tightened(const VoxelMap& map, std::vector<BandPoint> path) {
  const std::vector<Corner> corners = convexCorners(map);
  bool changed = true;
  while (changed) {
    changed = false;
    for (std::size_t i = 1; i + 1 < path.size();) {
      const BandPoint a = path[i - 1];
      const BandPoint b = path[i];
      const BandPoint c = path[i + 1];
      std::vector<BandPoint> chain;
      if (const Int s = sign(cross(b - a, c - b)); s != 0) {
        chain = hull(a, c, s, holding(corners, a, b, c));
      }
      if (chain.size() == 1 && chain.front() == b) {
        ++i;
        continue;
      }
      changed = true;
      const auto at = path.erase(path.begin() + static_cast<std::ptrdiff_t>(i));
      path.insert(at, chain.begin(), chain.end());
      i = std::max<std::size_t>(1, i - 1);
    }
  }
  return path;
}

bool passable(const VoxelMap& map, const BandPoint& p, const BandPoint& q) {
  const BandPoint d = q - p;
  for (Int u = 0; u <= map.shape.nz; ++u) {
    for (Int v = 0; v <= map.shape.nx; ++v) {
      // The open box against the line, by the separating axes u, v and across the line.
      const auto meets = [&](Int low_u, Int high_u, Int low_v, Int high_v) {
        if (std::max(p.u, q.u) <= low_u || std::min(p.u, q.u) >= high_u) return false;
        if (std::max(p.v, q.v) <= low_v || std::min(p.v, q.v) >= high_v) return false;
        Int least = 0;
        Int most = 0;
        for (const BandPoint& corner : {BandPoint{low_u, low_v}, BandPoint{low_u, high_v},
                                        BandPoint{high_u, low_v}, BandPoint{high_u, high_v}}) {
          least = std::min(least, cross(d, corner - p));
          most = std::max(most, cross(d, corner - p));
        }
        return least < 0 && most > 0;
      };
      const Int cu = u * kCell;
      const Int cv = v * kCell;
      if (solid(map, u, v)) {
        if (meets(cu, cu + kCell, cv, cv + kCell)) return false;
        // Faces between two occupied cells are inside too.
        if (solid(map, u + 1, v) && meets(cu + 1, cu + 2 * kCell - 1, cv, cv + kCell)) return false;
        if (solid(map, u, v + 1) && meets(cu, cu + kCell, cv + 1, cv + 2 * kCell - 1)) return false;
      }
      const bool pinch = (solid(map, u, v) && solid(map, u - 1, v - 1)) ||
                         (solid(map, u - 1, v) && solid(map, u, v - 1));
      const BandPoint corner{cu, cv};
      if (pinch && cross(d, corner - p) == 0 && dot(corner - p, corner - q) <= 0) return false;
    }
  }
  return true;
}

}  // namespace tautline::planning
