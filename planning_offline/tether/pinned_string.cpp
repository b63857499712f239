#include "planning_offline/tether/pinned_string.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "common/error.h"
#include "planning_offline/tether/grid_triangle.h"
#include "planning_offline/tether/reel_place.h"

namespace tautline::planning {
namespace {

constexpr int kNoAxis = -1;
// Lengths in cells, unless said otherwise. Why each is needed: docs/taut_string.md.
constexpr double kQuantum = 0x1p-30;  // of a contact's place along its edge
constexpr double kGrazing = 1e-5;     // a contact nearer to its neighbours' chord is straight
constexpr double kTogether = 1e-12;   // parts of a way: edges on one face are met at once
constexpr double kTurning = 1e-12;    // sine below which a string does not turn in a projection
constexpr double kSame = 1e-11;       // an edge so near to the anchor goes through it
constexpr double kRounding = 1e-13;   // of differences of coordinates
constexpr double kTouching = 1e-9;    // sine up to which a string lies in a face
constexpr double kAtEnd = 1e-9;       // of the free length: an edge is met by the string's very end

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

Eigen::Vector2d across(int axis, const Eigen::Vector3d& p) {
  return {p[axisU(axis)], p[axisV(axis)]};
}

}  // namespace

PinnedString::PinnedString(const VoxelMap& map, const Eigen::Vector3d& reel)
    : TreeString(checkedReel(map, reel), kGrazing * map.resolution),
      origin_(map.origin),
      resolution_(map.resolution),
      solid_(map),
      anchors_{cellsOf(reel)} {}

Eigen::Vector3d PinnedString::cellsOf(const Eigen::Vector3d& p_M) const {
  const Eigen::Vector3d cells = (p_M - origin_) / resolution_;
  TAUTLINE_CHECK((cells.array().abs() <= kFarthest).all());
  return cells;
}

StackId PinnedString::push(StackId stack, const Meeting& meeting) {
  const ConvexEdge& edge = meeting.edge;
  const auto placed = [&edge, &meeting](const Eigen::Vector2d& uv) {
    Eigen::Vector3d point;
    point[axisU(edge.axis)] = uv.x();
    point[axisV(edge.axis)] = uv.y();
    point[edge.axis] = meeting.place;
    return point;
  };
  const StackId id = tree().push(stack,
                                 {.edge = edge.packed(),
                                  .place = std::llround(meeting.place / kQuantum),
                                  .turn = meeting.turn},
                                 origin_ + resolution_ * placed(Eigen::Vector2d(edge.u, edge.v)));
  if (id == anchors_.size()) anchors_.push_back(placed(solid_.across(edge)));
  return id;
}

std::optional<double> PinnedString::release(StackId stack, const Eigen::Vector3d& x,
                                            const Leg& leg) const {
  if (stack == kStraight) return std::nullopt;
  const ContactKey& key = tree().key(stack);
  const int axis = ConvexEdge::unpacked(key.edge).axis;
  if (axis == leg.dead_axis) return std::nullopt;
  const Eigen::Vector2d contact = across(axis, anchors_[stack]);
  const Eigen::Vector2d incoming = contact - across(axis, anchors_[tree().pop(stack)]);
  // Signed area about the edge, positive while the string bends round it, linear along the way.
  const double now = key.turn * cross(incoming, across(axis, x) - contact);
  const double then = key.turn * cross(incoming, across(axis, leg.target) - contact);
  if (then > 0.0 || then >= now) return std::nullopt;
  return std::max(now, 0.0) / (std::max(now, 0.0) - then);
}

void PinnedString::meetEdges(int axis, const Eigen::Vector3d& c, const Eigen::Vector3d& p,
                             const Eigen::Vector3d& q, std::optional<Meeting>& first) const {
  const Eigen::Vector2d c2 = across(axis, c);
  const Eigen::Vector2d to_p = across(axis, p) - c2;
  const Eigen::Vector2d to_q = across(axis, q) - c2;
  const double area = cross(to_p, to_q);
  if (std::abs(area) <= kTurning * to_p.norm() * to_q.norm()) return;
  const int turn = area > 0.0 ? 1 : -1;
  const double p_w = p[axis] - c[axis];
  const double q_w = q[axis] - c[axis];
  // A point of the triangle is c + alpha (p − c) + beta (q − c); w is a linear function of (u, v).
  const double w_per_u = (p_w * to_q.y() - q_w * to_p.y()) / area;
  const double w_per_v = (q_w * to_p.x() - p_w * to_q.x()) / area;
  const double w_low = c[axis] + std::min({0.0, p_w, q_w});
  const double w_high = c[axis] + std::max({0.0, p_w, q_w});
  constexpr double kMargin = 2.0 * ShrunkSolid::kShrinkMax;
  const double w_margin = kMargin * (1.0 + std::abs(w_per_u) + std::abs(w_per_v));
  const ConvexEdges& edges = solid_.edges(axis);
  const Eigen::Vector3d normal = (p - c).cross(q - c);

  const auto consider = [&](int u, int v) {
    const double w = c[axis] + w_per_u * (u - c2.x()) + w_per_v * (v - c2.y());
    const double low = std::max({w - w_margin, w_low - kMargin, 0.0});
    const double high = std::min({w + w_margin, w_high + kMargin, 1.0 * edges.sizeW()});
    if (low > high) return;
    unsigned quadrants = 0;
    const int last = std::min(static_cast<int>(high), edges.sizeW() - 1);
    for (int k = static_cast<int>(low); k <= last; ++k) {
      quadrants |= edges.quadrants(u, v, k) | edges.joints(u, v, k);
    }
    for (int quadrant = 0; quadrants >> quadrant != 0; ++quadrant) {
      if ((quadrants >> quadrant & 1U) == 0) continue;
      const ConvexEdge edge{axis, u, v, quadrant};
      const Eigen::Vector2d r = solid_.across(edge) - c2;
      if (r.norm() < kSame) continue;
      const double alpha = cross(r, to_q) / area;
      const double beta = cross(to_p, r) / area;
      const double reach = alpha + beta;
      if (!(alpha > 0.0 && reach <= 1.0 + kAtEnd && beta >= -kTogether * reach)) continue;
      // The obstacle must lie ahead of the turning string.
      const double slack = kTouching * r.norm() + kRounding;
      if (turn * edge.sideU() * r.y() > slack || turn * edge.sideV() * r.x() < -slack) continue;
      const double part = std::max(beta / reach, 0.0);
      const bool earlier = !first || part < first->part - kTogether;
      // Of edges met at once the farthest: the string is straight at the others.
      const bool farther = first && part <= first->part + kTogether && reach > first->reach;
      if (!earlier && !farther) continue;
      const double place = c[axis] + alpha * p_w + beta * q_w;
      if (solid_.has(edge, place, normal)) first = Meeting{part, reach, place, edge, turn};
    }
  };
  for (const auto& [part_low, part_high] : near_.edges) {
    visitGridPointsBetween(c2, to_p, to_q, part_low, part_high, edges.sizeU(), edges.sizeV(),
                           kMargin, consider);
  }
}

std::optional<PinnedString::Meeting> PinnedString::firstMeeting(const Eigen::Vector3d& c,
                                                                const Eigen::Vector3d& p,
                                                                const Leg& leg) {
  std::optional<Meeting> first;
  near_ = solid_.field().near(c, p, leg.target);
  if (near_.edges.empty()) return first;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis != leg.dead_axis) meetEdges(axis, c, p, leg.target, first);
  }
  return first;
}

std::optional<StackId> PinnedString::drag(StackId stack, Eigen::Vector3d x,
                                          const Eigen::Vector3d& q) {
  constexpr int kEventsMax = 1000;
  legs_.assign(1, {q, kNoAxis});
  for (int events = 0; events < kEventsMax; ++events) {
    Leg& leg = legs_.back();
    const Eigen::Vector3d c = anchors_[stack];
    const std::optional<double> straight = release(stack, x, leg);
    const std::optional<Meeting> meeting = firstMeeting(c, x, leg);
    if (meeting && (!straight || meeting->part < *straight)) {
      x += meeting->part * (leg.target - x);
      stack = push(stack, *meeting);
    } else if (straight) {
      // The string swings off the contact: its end goes there and comes back along the string, in a
      // plane along the edge, so that no edge parallel to it can be met or released. What is left
      // of this leg is then seen from another anchor.
      const Eigen::Vector3d back = x + *straight * (leg.target - x);
      const int axis = ConvexEdge::unpacked(tree().key(stack).edge).axis;
      leg.dead_axis = kNoAxis;
      stack = tree().pop(stack);
      x = c;
      legs_.push_back({back, axis});
    } else {
      x = leg.target;
      legs_.pop_back();
      if (legs_.empty()) return stack;
    }
  }
  return std::nullopt;
}

bool PinnedString::free(StackId stack, const Eigen::Vector3d& end) {
  if (solid_.penetrated(anchors_[stack], end, near_.occupied)) return false;
  for (StackId s = stack; s != kStraight; s = tree().pop(s)) {
    if (s < checked_.size() && checked_[s] != 0) break;
    const Eigen::Vector3d& from = anchors_[tree().pop(s)];
    const Stretches near = solid_.field().near(from, anchors_[s], anchors_[s]).occupied;
    if (solid_.penetrated(from, anchors_[s], near)) return false;
  }
  if (stack >= checked_.size()) checked_.resize(stack + std::size_t{1}, 0);
  checked_[stack] = 1;
  return true;
}

StackId PinnedString::move(StackId stack, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d p = cellsOf(from);
  const Eigen::Vector3d q = cellsOf(to);
  const std::optional<StackId> direct = drag(stack, p, q);
  if (direct && free(*direct, q)) return *direct;
  // Two events came too close to each other to be told apart: not so a little aside.
  const std::array<Eigen::Vector3d, 6> asides{{{3e-4, 1e-4, -2e-4},
                                               {-2e-4, 3e-4, 1e-4},
                                               {-1e-4, -2e-4, -3e-4},
                                               {2e-4, -1e-4, 3e-4},
                                               {-3e-4, 2e-4, -1e-4},
                                               {1e-4, -3e-4, 2e-4}}};
  for (const Eigen::Vector3d& aside : asides) {
    const Eigen::Vector3d via = 0.5 * (p + q) + aside;
    const std::optional<StackId> half = drag(stack, p, via);
    const std::optional<StackId> whole = half ? drag(*half, via, q) : std::nullopt;
    if (whole && free(*whole, q)) return *whole;
  }
  ++unresolved_;
  return direct.value_or(stack);
}

}  // namespace tautline::planning
