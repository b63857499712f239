#include "planning_offline/tether/shrunk_solid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tautline::planning {
namespace {

constexpr double kShrinkMin = 0.5e-6;
/// A string comes to the very end of an edge, up to rounding, where it slides along another edge to
/// it, or lies in the plane of the end. Ends that stop it reach a little further, the others are a
/// little short.
constexpr double kStops = 1e-9;
constexpr double kTouches = -1e-12;

/// A number in [0, 1) for each n: SplitMix64, from its published constants.
double scattered(std::uint64_t n) {
  n = (n + 1) * 0x9E3779B97F4A7C15;
  n = (n ^ n >> 30U) * 0xBF58476D1CE4E5B9;
  n = (n ^ n >> 27U) * 0x94D049BB133111EB;
  return static_cast<double>((n ^ n >> 31U) >> 11U) * 0x1p-53;
}

Eigen::Vector3i cellOf(const Eigen::Vector3d& p) { return p.array().floor().cast<int>(); }

std::vector<double> movedPlanes(int axis, int cells) {
  std::vector<double> planes;
  for (int k = 0; k <= cells; ++k) {
    for (const int side : {-1, 1}) {
      const std::int64_t n = 3 * (2 * std::int64_t{k} + (side > 0 ? 1 : 0)) + axis;
      const double part = scattered(static_cast<std::uint64_t>(n));
      planes.push_back(k + side * (kShrinkMin + (ShrunkSolid::kShrinkMax - kShrinkMin) * part));
    }
  }
  return planes;
}

/// Marks all cells from lo to hi, both included, that are on the grid.
void mark(const GridShape& shape, const Eigen::Vector3i& lo, const Eigen::Vector3i& hi,
          std::vector<std::uint8_t>& marked) {
  const Eigen::Vector3i first = lo.cwiseMax(0);
  const Eigen::Vector3i last =
      hi.cwiseMin(Eigen::Vector3i(shape.nx, shape.ny, shape.nz) - Eigen::Vector3i::Ones());
  for (int z = first.z(); z <= last.z(); ++z) {
    for (int y = first.y(); y <= last.y(); ++y) {
      for (int x = first.x(); x <= last.x(); ++x) {
        marked[static_cast<std::size_t>(shape.index({x, y, z}))] = 1;
      }
    }
  }
}

std::vector<std::uint8_t> touchingEdges(const GridShape& shape,
                                        const std::array<ConvexEdges, 3>& all) {
  std::vector<std::uint8_t> marked(shape.size(), 0);
  for (const ConvexEdges& edges : all) {
    Eigen::Vector3i at;
    int& w = at[edges.axis()];
    int& v = at[axisV(edges.axis())];
    int& u = at[axisU(edges.axis())];
    for (w = 0; w < edges.sizeW(); ++w) {
      for (v = 0; v <= edges.sizeV(); ++v) {
        for (u = 0; u <= edges.sizeU(); ++u) {
          if ((edges.quadrants(u, v, w) | edges.joints(u, v, w)) == 0) continue;
          Eigen::Vector3i end = at;
          ++end[edges.axis()];
          mark(shape, at - Eigen::Vector3i::Ones(), end, marked);
        }
      }
    }
  }
  return marked;
}

std::vector<std::uint8_t> touchingOccupied(const VoxelMap& map) {
  std::vector<std::uint8_t> marked(map.shape.size(), 0);
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    if (map.cells[i] != CellState::kOccupied) continue;
    const Eigen::Vector3i cell = map.shape.cell(static_cast<CellIndex>(i));
    mark(map.shape, cell - Eigen::Vector3i::Ones(), cell + Eigen::Vector3i::Ones(), marked);
  }
  return marked;
}

/// True if a plane through the end of an edge goes through the inside of the cell there, which lies
/// to `side` of that end along the edge.
bool cutsCorner(const Eigen::Vector3d& normal, const ConvexEdge& edge, int side) {
  constexpr double kParallel = 1e-9;
  const double least = kParallel * normal.norm();
  const std::array<double, 3> slopes{edge.sideU() * normal[axisU(edge.axis)],
                                     edge.sideV() * normal[axisV(edge.axis)],
                                     side * normal[edge.axis]};
  const auto [low, high] = std::minmax_element(slopes.begin(), slopes.end());
  return *low<-least&& * high> least;
}

}  // namespace

ShrunkSolid::ShrunkSolid(const VoxelMap& map)
    : shape_(map.shape),
      cells_(map.cells),
      edges_{ConvexEdges(map, 0), ConvexEdges(map, 1), ConvexEdges(map, 2)},
      planes_{movedPlanes(0, map.shape.nx), movedPlanes(1, map.shape.ny),
              movedPlanes(2, map.shape.nz)},
      field_(map.shape, touchingEdges(map.shape, edges_), touchingOccupied(map)) {}

bool ShrunkSolid::solid(const ConvexEdge& edge, int w) const noexcept {
  Eigen::Vector3i cell;
  cell[axisU(edge.axis)] = edge.sideU() > 0 ? edge.u : edge.u - 1;
  cell[axisV(edge.axis)] = edge.sideV() > 0 ? edge.v : edge.v - 1;
  cell[edge.axis] = w;
  return occupied(cell);
}

bool ShrunkSolid::has(const ConvexEdge& edge, double w,
                      const Eigen::Vector3d& normal) const noexcept {
  const ConvexEdges& all = edges(edge.axis);
  const auto convex = [&all, &edge](int slab) {
    return slab >= 0 && slab < all.sizeW() &&
           (all.quadrants(edge.u, edge.v, slab) >> edge.quadrant & 1U) != 0;
  };
  const int k = static_cast<int>(std::lround(w));
  if (std::abs(w - k) > 2.0 * kShrinkMax || k < 0 || k > all.sizeW()) {
    return convex(static_cast<int>(std::floor(w)));
  }
  const double low = plane(edge.axis, k, false);
  const double high = plane(edge.axis, k, true);
  const bool joint = k < all.sizeW() && (all.joints(edge.u, edge.v, k) >> edge.quadrant & 1U) != 0;
  if (joint && low - kStops <= w && w <= high + kStops) return true;
  const bool wall = solid(edge, k - 1) && solid(edge, k);
  const auto over = [&](int side) {
    return wall || cutsCorner(normal, edge, side) ? kStops : kTouches;
  };
  return (convex(k - 1) && w <= low + over(-1)) || (convex(k) && w >= high - over(1));
}

int ShrunkSolid::layerAt(int axis, double w) const noexcept {
  const int k = std::clamp(static_cast<int>(std::lround(w)), 0, edges(axis).sizeW());
  if (w < plane(axis, k, false)) return 2 * k - 1;
  return w > plane(axis, k, true) ? 2 * k + 1 : 2 * k;
}

double ShrunkSolid::layerEnd(int axis, int layer) const noexcept {
  return layer % 2 == 0 ? plane(axis, layer / 2, true) : plane(axis, (layer + 1) / 2, false);
}

bool ShrunkSolid::convexIn(const ConvexEdge& edge, int layer) const noexcept {
  const ConvexEdges& all = edges(edge.axis);
  const int k = layer / 2;
  if (layer < 0 || k >= all.sizeW()) return false;
  const unsigned mask =
      layer % 2 != 0 ? all.quadrants(edge.u, edge.v, k) : all.joints(edge.u, edge.v, k);
  return (mask >> edge.quadrant & 1U) != 0;
}

bool ShrunkSolid::solidIn(const ConvexEdge& edge, int layer) const noexcept {
  const int k = layer / 2;
  return layer >= 0 && solid(edge, k) && (layer % 2 != 0 || solid(edge, k - 1));
}

EdgeRun ShrunkSolid::runAround(const ConvexEdge& edge, double w) const noexcept {
  int layer = layerAt(edge.axis, w);
  // A contact may stand a little beyond an end that stops.
  for (const double aside : {-2.0 * kStops, 2.0 * kStops}) {
    if (!convexIn(edge, layer)) layer = layerAt(edge.axis, w + aside);
  }
  if (!convexIn(edge, layer)) return {.low = w, .high = w};
  int first = layer;
  int last = layer;
  while (convexIn(edge, first - 1)) --first;
  while (convexIn(edge, last + 1)) ++last;
  return {.low = layerEnd(edge.axis, first - 1),
          .high = layerEnd(edge.axis, last),
          .slips_low = !solidIn(edge, first - 1),
          .slips_high = !solidIn(edge, last + 1)};
}

std::vector<ShrunkSolid::EdgeEnd> ShrunkSolid::edgesFrom(const Eigen::Vector3d& corner) const {
  constexpr double kNear = 1e-7;
  std::vector<EdgeEnd> found;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector2d at(corner[axisU(axis)], corner[axisV(axis)]);
    const int u = static_cast<int>(std::lround(at.x()));
    const int v = static_cast<int>(std::lround(at.y()));
    if (u < 0 || v < 0 || u > edges(axis).sizeU() || v > edges(axis).sizeV()) continue;
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      const ConvexEdge edge{axis, u, v, quadrant};
      if ((across(edge) - at).cwiseAbs().maxCoeff() > kNear) continue;
      for (const int side : {-1, 1}) {
        const bool here = convexIn(edge, layerAt(axis, corner[axis] + 2.0 * side * kNear));
        if (here && !convexIn(edge, layerAt(axis, corner[axis] - 2.0 * side * kNear)))
          found.push_back({edge, side});
      }
    }
  }
  return found;
}

double ShrunkSolid::depth(const Eigen::Vector3d& p) const noexcept {
  const Eigen::Vector3i cell = cellOf(p);
  if (!occupied(cell)) return 0.0;
  double least = 1.0;
  for (int n = 0; n < 27; ++n) {
    const Eigen::Vector3i way(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    if (occupied(cell + way)) continue;
    double out = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double within = p[axis] - cell[axis];
      if (way[axis] != 0) out = std::max(out, way[axis] > 0 ? 1.0 - within : within);
    }
    least = std::min(least, out);
  }
  return least;
}

bool ShrunkSolid::penetrated(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                             const Stretches& near) const noexcept {
  for (const auto& [low, high] : near) {
    const Eigen::Vector3d from = a + low * (b - a);
    if (penetratedAnywhere(from, high < 1.0 ? Eigen::Vector3d(a + high * (b - a)) : b)) return true;
  }
  return false;
}

bool ShrunkSolid::penetratedAnywhere(const Eigen::Vector3d& a,
                                     const Eigen::Vector3d& b) const noexcept {
  constexpr double kShortest = 1e-4;
  const Eigen::Vector3d d = b - a;
  const double length = d.norm();
  // The part of the line over the grid, then cell by cell to the next plane crossed.
  double part = 0.0;
  double end = 1.0;
  const Eigen::Vector3d size(shape_.nx, shape_.ny, shape_.nz);
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0.0) {
      if (a[axis] < 0.0 || a[axis] > size[axis]) return false;
      continue;
    }
    const double enter = ((d[axis] > 0.0 ? 0.0 : size[axis]) - a[axis]) / d[axis];
    const double leave = ((d[axis] > 0.0 ? size[axis] : 0.0) - a[axis]) / d[axis];
    part = std::max(part, enter);
    end = std::min(end, leave);
  }
  while (part < end) {
    double next = end;
    for (int axis = 0; axis < 3; ++axis) {
      if (d[axis] == 0.0) continue;
      const double x = a[axis] + part * d[axis];
      double plane = d[axis] > 0.0 ? std::floor(x) + 1.0 : std::ceil(x) - 1.0;
      double crossing = (plane - a[axis]) / d[axis];
      if (crossing <= part) crossing = (plane + std::copysign(1.0, d[axis]) - a[axis]) / d[axis];
      next = std::min(next, crossing);
    }
    const auto at = [&](double place) -> Eigen::Vector3d {
      return a + (part + place * (next - part)) * d;
    };
    if ((next - part) * length > kShortest && occupied(cellOf(at(0.5)))) {
      // At two places: a line can be deepest at either end, but not in between only.
      if (depth(at(0.25)) > kDepthMax || depth(at(0.75)) > kDepthMax) return true;
    }
    part = next;
  }
  return false;
}

}  // namespace tautline::planning
