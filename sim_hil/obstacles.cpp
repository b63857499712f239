#include "sim_hil/obstacles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <Eigen/Geometry>

#include "common/error.h"
#include "sim_hil/convex_pieces.h"

namespace tautline::sim {
namespace {

std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }

// Features: faces 0 top, 1 bottom, 2 + i side i; edges kFirstEdge + group + i.
constexpr int kVerticalEdge = kFirstEdge;   // at corner i
constexpr int kTopEdge = kFirstEdge + 100;  // of side i
constexpr int kBottomEdge = kFirstEdge + 200;

ConvexPrism makePrism(const ConvexPiece& piece, double y_min, double y_max, int obstacle) {
  ConvexPrism prism;
  prism.corner_count = static_cast<int>(piece.corner.size());
  prism.y_min = y_min;
  prism.y_max = y_max;
  prism.obstacle = obstacle;
  for (std::size_t i = 0; i < piece.corner.size(); ++i) {
    const Eigen::Vector2d side = piece.corner[(i + 1) % piece.corner.size()] - piece.corner[i];
    prism.corner[i] = piece.corner[i];
    prism.normal[i] = Eigen::Vector2d(side.y(), -side.x()).normalized();
    prism.offset[i] = prism.normal[i].dot(piece.corner[i]);
    prism.inner[i] = piece.inner[i];
  }
  return prism;
}

/// (z, x) of a world vector.
Eigen::Vector2d plan(const Eigen::Vector3d& p) noexcept { return {p.z(), p.x()}; }

/// The separating-axis test of a segment and a prism: keeps the axis of least overlap.
struct BestAxis {
  double depth{std::numeric_limits<double>::max()};
  Eigen::Vector3d normal{Eigen::Vector3d::UnitY()};
  int side{-1};      ///< Face: 0 top, 1 bottom, 2 + i side i.
  bool edge{false};  ///< The axis belongs to the edges along `edge_direction`.
  Eigen::Vector3d edge_direction{Eigen::Vector3d::UnitY()};
};

/// Top corner 3-D coordinates; bottom differs in y only.
Eigen::Vector3d cornerAt(const ConvexPrism& prism, int i, double y) noexcept {
  const Eigen::Vector2d& c = prism.corner[index(i)];
  return {c.y(), y, c.x()};
}

double support(const ConvexPrism& prism, const Eigen::Vector3d& n) noexcept {
  double best = std::numeric_limits<double>::lowest();
  for (int i = 0; i < prism.corner_count; ++i) {
    best = std::fmax(best, n.z() * prism.corner[index(i)].x() + n.x() * prism.corner[index(i)].y());
  }
  return best + std::fmax(n.y() * prism.y_min, n.y() * prism.y_max);
}

bool tryFaces(const ConvexPrism& prism, const Eigen::Vector3d& p0, const Eigen::Vector3d& p1,
              double margin, BestAxis& best) noexcept {
  const auto consider = [&](double depth, const Eigen::Vector3d& n, int side) {
    if (depth < best.depth) best = {depth, n, side, false, Eigen::Vector3d::UnitY()};
    return depth > -margin;
  };
  if (!consider(prism.y_max - std::fmin(p0.y(), p1.y()), Eigen::Vector3d::UnitY(), 0)) return false;
  if (!consider(std::fmax(p0.y(), p1.y()) - prism.y_min, -Eigen::Vector3d::UnitY(), 1)) {
    return false;
  }
  for (int i = 0; i < prism.corner_count; ++i) {
    const Eigen::Vector2d& n = prism.normal[index(i)];
    const double depth = prism.offset[index(i)] - std::fmin(n.dot(plan(p0)), n.dot(plan(p1)));
    if (prism.inner[index(i)]) {
      if (depth < -margin) return false;
      continue;
    }
    if (!consider(depth, {n.y(), 0.0, n.x()}, 2 + i)) return false;
  }
  return true;
}

/// Axes perpendicular to the segment and to one direction of edges.
bool tryEdges(const ConvexPrism& prism, const Eigen::Vector3d& p0, const Eigen::Vector3d& t,
              const Eigen::Vector3d& direction, double margin, BestAxis& best) noexcept {
  constexpr double kPreferEdge = 1e-6;  // a segment flat on a narrow face rests on its edges [m]
  Eigen::Vector3d n = t.cross(direction);
  const double norm = n.norm();
  if (norm < 1e-6) return true;  // parallel: the faces decide
  n /= norm;
  for (int flip = 0; flip < 2; ++flip, n = -n) {
    const double depth = support(prism, n) - n.dot(p0);
    if (depth < -margin) return false;
    if (depth < best.depth + kPreferEdge) best = {depth, n, -1, true, direction};
  }
  return true;
}

int faceContact(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1, const BestAxis& axis,
                std::span<SegmentContact, kMaxSegmentContacts> out) noexcept {
  const double at_0 = axis.normal.dot(p0);
  const double at_1 = axis.normal.dot(p1);
  out[0] = {at_0 < at_1 ? 0.0 : 1.0, axis.normal, std::fmin(at_0, at_1) + axis.depth, axis.side};
  return 1;
}

/// Contacts with every edge along the axis' direction that the segment crosses too deep.
int edgeContacts(const ConvexPrism& prism, const Eigen::Vector3d& p0, const Eigen::Vector3d& p1,
                 const BestAxis& axis, double margin,
                 std::span<SegmentContact, kMaxSegmentContacts> out) noexcept {
  const Eigen::Vector3d b = axis.edge_direction.cross(axis.normal);
  const double along = (p1 - p0).dot(b);
  if (std::abs(along) < 1e-9) return 0;
  int count = 0;
  const auto consider = [&](const Eigen::Vector3d& a, double extent, int feature) {
    const double offset = axis.normal.dot(a);
    const double s = (a - p0).dot(b) / along;
    if (count == kMaxSegmentContacts || s < 0.0 || s > 1.0) return;
    const Eigen::Vector3d p = p0 + s * (p1 - p0);
    if (offset - axis.normal.dot(p) < -margin) return;
    const double e = (p - a).dot(axis.edge_direction);
    if (e < -margin || e > extent + margin) return;
    out[index(count++)] = {s, axis.normal, offset, feature};
  };
  const bool vertical = axis.edge_direction.y() > 0.5;
  for (int i = 0; i < prism.corner_count; ++i) {
    const int before = (i + prism.corner_count - 1) % prism.corner_count;
    if (vertical) {
      if (prism.inner[index(i)] || prism.inner[index(before)]) continue;
      consider(cornerAt(prism, i, prism.y_min), prism.y_max - prism.y_min, kVerticalEdge + i);
      continue;
    }
    if (prism.inner[index(i)]) continue;
    const int next = (i + 1) % prism.corner_count;
    const Eigen::Vector3d side = cornerAt(prism, next, 0.0) - cornerAt(prism, i, 0.0);
    const double extent = side.dot(axis.edge_direction);
    if (std::abs(extent) < (1.0 - 1e-9) * side.norm()) continue;
    const int start = extent > 0.0 ? i : next;
    for (const double y : {prism.y_max, prism.y_min}) {
      consider(cornerAt(prism, start, y), std::abs(extent),
               (y == prism.y_max ? kTopEdge : kBottomEdge) + i);
    }
  }
  return count;
}

}  // namespace

int segmentContacts(const ConvexPrism& prism, const Eigen::Vector3d& p0, const Eigen::Vector3d& p1,
                    double margin, std::span<SegmentContact, kMaxSegmentContacts> out) noexcept {
  BestAxis best;
  if (!tryFaces(prism, p0, p1, margin, best)) return 0;
  const BestAxis face = best;
  const Eigen::Vector3d t = (p1 - p0).normalized();
  if (!tryEdges(prism, p0, t, Eigen::Vector3d::UnitY(), margin, best)) return 0;
  for (int i = 0; i < prism.corner_count; ++i) {
    const Eigen::Vector2d& n = prism.normal[index(i)];
    if (!tryEdges(prism, p0, t, {n.x(), 0.0, -n.y()}, margin, best)) return 0;
  }
  if (best.edge) {
    const int count = edgeContacts(prism, p0, p1, best, margin, out);
    if (count > 0) return count;
  }
  // No edge within the segment's length. A face much farther off than that edge is not what it
  // meets.
  const bool face_is_near = face.side >= 0 && face.depth <= best.depth + 3.0 * margin;
  return face_is_near ? faceContact(p0, p1, face, out) : 0;
}

SolidEdge edgeOf(const ConvexPrism& prism, int feature) noexcept {
  const auto normal = [&](int side) -> Eigen::Vector3d {
    const Eigen::Vector2d& n = prism.normal[index(side)];
    return {n.y(), 0.0, n.x()};
  };
  const int i = (feature - kFirstEdge) % 100;
  SolidEdge edge;
  if (feature < kTopEdge) {
    const int before = (i + prism.corner_count - 1) % prism.corner_count;
    edge.start = cornerAt(prism, i, prism.y_min);
    edge.length = prism.y_max - prism.y_min;
    edge.outward = (normal(i) + normal(before)).normalized();
    return edge;
  }
  const bool top = feature < kBottomEdge;
  const double y = top ? prism.y_max : prism.y_min;
  edge.start = cornerAt(prism, i, y);
  const Eigen::Vector3d side = cornerAt(prism, (i + 1) % prism.corner_count, y) - edge.start;
  edge.length = side.norm();
  edge.direction = side / edge.length;
  edge.outward = (normal(i) + Eigen::Vector3d(0.0, top ? 1.0 : -1.0, 0.0)).normalized();
  return edge;
}

double signedDistance(const ConvexPrism& prism, const Eigen::Vector3d& p) noexcept {
  const Eigen::Vector2d q = plan(p);
  double inside = std::numeric_limits<double>::lowest();
  double outside_squared = std::numeric_limits<double>::max();
  for (int i = 0; i < prism.corner_count; ++i) {
    inside = std::fmax(inside, prism.normal[index(i)].dot(q) - prism.offset[index(i)]);
    const Eigen::Vector2d a = prism.corner[index(i)];
    const Eigen::Vector2d side = prism.corner[index((i + 1) % prism.corner_count)] - a;
    const double t = std::clamp((q - a).dot(side) / side.squaredNorm(), 0.0, 1.0);
    outside_squared = std::fmin(outside_squared, (q - a - t * side).squaredNorm());
  }
  const double horizontal = inside <= 0.0 ? inside : std::sqrt(outside_squared);
  const double vertical = std::fmax(prism.y_min - p.y(), p.y() - prism.y_max);
  if (horizontal <= 0.0 && vertical <= 0.0) return std::fmax(horizontal, vertical);
  return std::hypot(std::fmax(horizontal, 0.0), std::fmax(vertical, 0.0));
}

Obstacles::Obstacles(const Scene& world) : floor_(world.floor) {
  has_room_ = (world.max.array() > world.min.array()).all();
  if (has_room_) {
    room_.include(world.min);
    room_.include(world.max);
  }
  int obstacle = 0;
  for (const Box& box : world.boxes) {
    Prism prism;
    prism.name = box.name;
    prism.footprint = {{box.min.z(), box.min.x()},
                       {box.max.z(), box.min.x()},
                       {box.max.z(), box.max.x()},
                       {box.min.z(), box.max.x()}};
    prism.y_min = box.min.y();
    prism.y_max = box.max.y();
    addPrism(prism, obstacle++);
  }
  for (const Prism& prism : world.prisms) addPrism(prism, obstacle++);
}

void Obstacles::addPrism(const Prism& prism, int obstacle) {
  for (const ConvexPiece& piece : convexPieces(prism.footprint)) {
    if (piece.corner.size() > kMaxPrismCorners || solids_.size() == kMaxSolids) {
      throw InputError({.file = {},
                        .line = 0,
                        .key = "obstacle \"" + prism.name + "\"",
                        .problem = "more than the simulator takes",
                        .allowed = std::to_string(kMaxSolids) + " solids, " +
                                   std::to_string(kMaxPrismCorners) + " corners a convex piece",
                        .remedy = "simplify the scene"});
    }
    solids_.push_back(makePrism(piece, prism.y_min, prism.y_max, obstacle));
    Aabb box;
    for (const Eigen::Vector2d& c : piece.corner) {
      box.include({c.y(), prism.y_min, c.x()});
      box.include({c.y(), prism.y_max, c.x()});
    }
    bounds_.push_back(box);
  }
}

double Obstacles::groundBelow(const Eigen::Vector3d& p) const noexcept {
  constexpr double kTolerance = 0.02;  // a vehicle pressed a little into its support [m]
  double ground = floor_;
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    const ConvexPrism& solid = solids_[i];
    if (solid.y_max <= ground || p.y() < solid.y_max - kTolerance) continue;
    if (signedDistance(solid, {p.x(), solid.y_min, p.z()}) > 0.0) continue;  // not above it
    ground = solid.y_max;
  }
  return ground;
}

bool Obstacles::touches(const Eigen::Vector3d& p, double radius, double foot) const noexcept {
  const Aabb point{p, p};
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    if (p.y() - foot >= solids_[i].y_max || !bounds_[i].overlaps(point, radius)) continue;
    if (signedDistance(solids_[i], p) < radius) return true;
  }
  return false;
}

double Obstacles::clearance(const Eigen::Vector3d& p, bool with_room) const noexcept {
  double distance = std::numeric_limits<double>::max();
  for (const ConvexPrism& solid : solids_) distance = std::fmin(distance, signedDistance(solid, p));
  if (with_room && has_room_) {
    distance = std::fmin(distance, (p - room_.min).cwiseMin(room_.max - p).minCoeff());
  }
  return distance;
}

double Obstacles::confinement(const Eigen::Vector3d& p, double decay) const noexcept {
  std::array<double, 6> nearest;  // towards -x, -y, -z, +x, +y, +z
  nearest.fill(std::numeric_limits<double>::max());
  nearest[1] = p.y() - floor_;
  if (has_room_) {
    for (int axis = 0; axis < 3; ++axis) {
      double& low = nearest[static_cast<std::size_t>(axis)];
      low = std::fmin(low, p[axis] - room_.min[axis]);
      nearest[static_cast<std::size_t>(axis + 3)] = room_.max[axis] - p[axis];
    }
  }
  for (std::size_t i = 0; i < solids_.size(); ++i) {
    const Eigen::Vector3d way = p.cwiseMax(bounds_[i].min).cwiseMin(bounds_[i].max) - p;
    Eigen::Index axis = 0;
    way.cwiseAbs().maxCoeff(&axis);
    double& side = nearest[static_cast<std::size_t>(axis + (way[axis] > 0.0 ? 3 : 0))];
    if (way.norm() < side) side = std::fmin(side, signedDistance(solids_[i], p));
  }
  double sum = 0.0;
  for (const double d : nearest) sum += std::exp(-std::fmax(d, 0.0) / decay);
  return sum;
}

}  // namespace tautline::sim
