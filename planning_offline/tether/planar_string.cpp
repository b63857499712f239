#include "planning_offline/tether/planar_string.h"

#include <cmath>

#include "common/error.h"
#include "planning_offline/field/reel_place.h"
#include "planning_offline/tether/grid_triangle.h"

namespace tautline::planning {
namespace {

using Fine = Eigen::Matrix<std::int64_t, 2, 1>;

constexpr int kY = 1;
constexpr std::int64_t kCell = 1024;         // power of two: rounding and grid points are exact
static_assert(kFarthest * kCell < 1 << 29);  // so that sums of two products are below 2^62

std::int64_t cross(const Fine& a, const Fine& b) { return a.x() * b.y() - a.y() * b.x(); }
int sign(std::int64_t x) { return (x > 0) - (x < 0); }

Eigen::Vector3d intoPlane(const VoxelMap& map, const Eigen::Vector3d& p) {
  return {p.x(), map.origin.y() + 0.5 * map.resolution, p.z()};
}

}  // namespace

PlanarString::PlanarString(const VoxelMap& map, const Eigen::Vector3d& reel)
    : TreeString(checkedReel(map, intoPlane(map, reel)), 0.0),
      origin_(map.origin),
      resolution_(map.resolution),
      corners_(map, kY),
      reel_(fine(reel)) {
  TAUTLINE_CHECK(map.shape.planar());
}

PlanarString::Fine PlanarString::fine(const Eigen::Vector3d& p_M) const {
  const Eigen::Vector3d cells = (p_M - origin_) / resolution_;
  TAUTLINE_CHECK(std::abs(cells.x()) <= kFarthest && std::abs(cells.z()) <= kFarthest);
  return {std::llround(cells.z() * kCell), std::llround(cells.x() * kCell)};
}

PlanarString::Fine PlanarString::anchorOf(StackId stack) const {
  if (stack == kStraight) return reel_;
  const ConvexEdge edge = ConvexEdge::unpacked(tree().key(stack).edge);
  return {edge.u * kCell, edge.v * kCell};
}

StackId PlanarString::push(StackId stack, const Corner& corner, int turn) {
  const Eigen::Vector3d point(origin_.x() + resolution_ * corner.edge.v, reel().y(),
                              origin_.z() + resolution_ * corner.edge.u);
  return tree().push(stack, {.edge = corner.edge.packed(), .place = 0, .turn = turn}, point);
}

std::optional<PlanarString::Corner> PlanarString::firstCorner(const Fine& a, const Fine& ray,
                                                              const Fine& p, const Fine& q,
                                                              int turn) const {
  constexpr double kRounding = 1e-9;  // of the rows' ends [cells]; the decision is exact
  const auto cells = [](const Fine& x) { return Eigen::Vector2d(x.cast<double>() / kCell); };
  std::optional<Corner> first;
  Fine best = q - a;
  const auto consider = [&](int u, int v) {
    const unsigned quadrants = corners_.quadrants(u, v, 0);
    if (quadrants == 0) return;
    const Fine point(u * kCell, v * kCell);
    const Fine r = point - a;
    if (turn * cross(ray, r) < 0 || turn * cross(r, q - a) <= 0) return;
    // Nearest in angle; of those in line the farthest: the string is straight at the others.
    const std::int64_t before = turn * cross(r, best);
    if (before < 0 || (before == 0 && r.squaredNorm() <= best.squaredNorm())) return;
    const std::int64_t depth = turn * cross(q - p, point - p);
    if (depth < 0) return;
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      if ((quadrants >> quadrant & 1U) == 0) continue;
      const ConvexEdge edge{kY, u, v, quadrant};
      const Fine side_u(edge.sideU(), 0);
      const Fine side_v(0, edge.sideV());
      // The obstacle lies ahead, and a vehicle that grazes it passes on its far side.
      const bool ahead = turn * cross(r, side_u) >= 0 && turn * cross(r, side_v) >= 0;
      const bool inside = depth > 0 || turn * cross(q - p, side_u + side_v) > 0;
      if (!ahead || !inside) continue;
      first = Corner{point, edge};
      best = r;
    }
  };
  visitGridPoints(cells(a), cells(p), cells(q), corners_.sizeU(), corners_.sizeV(), kRounding,
                  consider);
  return first;
}

StackId PlanarString::move(StackId stack, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Fine p = fine(from);
  const Fine q = fine(to);
  Fine ray = p - anchorOf(stack);
  // Every turn of the loop pushes or pops. A contact that was pushed turns the way the string turns
  // and is not released in the same move, unless the end comes to it on its line; every push cuts
  // the triangle that is left, so the loop ends.
  while (true) {
    const Fine a = anchorOf(stack);
    const int turn = sign(cross(p - a, q - a));
    if (turn == 0) {
      // Along the line through the anchor. Where the end comes to the last contact itself, the
      // string is straight; where it has just left it, or never does, nothing happens.
      if (stack == kStraight || p == a || (p - a).dot(q - a) > 0) return stack;
      stack = tree().pop(stack);
      p = a;
      ray = a - anchorOf(stack);
      continue;
    }
    const std::optional<Corner> corner = firstCorner(a, ray, p, q, turn);
    if (stack != kStraight && tree().key(stack).turn == -turn) {
      const StackId below = tree().pop(stack);
      const Fine straight = a - anchorOf(below);
      const bool straightens = turn * cross(straight, q - a) >= 0;
      if (straightens && !(corner && turn * cross(corner->point - a, straight) > 0)) {
        stack = below;
        ray = straight;
        continue;
      }
    }
    if (!corner) return stack;
    if (cross(q - p, corner->point - p) == 0) p = corner->point;  // grazed by the end itself
    ray = corner->point - a;
    stack = push(stack, *corner, turn);
  }
}

}  // namespace tautline::planning
