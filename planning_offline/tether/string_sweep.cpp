#include "planning_offline/tether/string_sweep.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "planning_offline/tether/grid_triangle.h"

namespace tautline::planning {
namespace {

// Lengths in cells, unless said otherwise. Why each is needed: docs/taut_string.md.
constexpr double kTogether = 1e-12;  // parts of a way: edges on one face are met at once
constexpr double kTurning = 1e-12;   // sine below which a string does not turn in a projection
constexpr double kSame = 1e-11;      // an edge so near to the anchor goes through it
constexpr double kRounding = 1e-13;  // of differences of coordinates
constexpr double kTouching = 1e-9;   // sine up to which a string lies in a face
constexpr double kAtEnd = 1e-9;      // of the free length: an edge is met by the string's very end

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

double bendArea(const Bend& bend, const Eigen::Vector3d& a, const Eigen::Vector3d& b) noexcept {
  const int axis = bend.edge.axis;
  const Eigen::Vector2d at = across(axis, bend.at);
  return bend.turn * cross(at - across(axis, a), across(axis, b) - at);
}

const std::array<Eigen::Vector3d, 6>& StringSweep::asides() {
  static const std::array<Eigen::Vector3d, 6> kAsides{{{3e-4, 1e-4, -2e-4},
                                                       {-2e-4, 3e-4, 1e-4},
                                                       {-1e-4, -2e-4, -3e-4},
                                                       {2e-4, -1e-4, 3e-4},
                                                       {-3e-4, 2e-4, -1e-4},
                                                       {1e-4, -3e-4, 2e-4}}};
  return kAsides;
}

std::optional<double> StringSweep::release(const Bend& last, const Eigen::Vector3d& below,
                                           const Eigen::Vector3d& x, const Leg& leg) {
  if (last.edge.axis == leg.dead_axis) return std::nullopt;
  // Linear along the way.
  const double now = bendArea(last, below, x);
  const double then = bendArea(last, below, leg.target);
  if (then > 0.0 || then >= now) return std::nullopt;
  return std::max(now, 0.0) / (std::max(now, 0.0) - then);
}

void StringSweep::meetEdges(int axis, const Eigen::Vector3d& c, const Eigen::Vector3d& p,
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
      if (solid_.has(edge, place, normal))
        first = Meeting{part, reach, {solid_.pointOn(edge, place), edge, turn}};
    }
  };
  for (const auto& [part_low, part_high] : near_.edges) {
    visitGridPointsBetween(c2, to_p, to_q, part_low, part_high, edges.sizeU(), edges.sizeV(),
                           kMargin, consider);
  }
}

std::optional<StringSweep::Meeting> StringSweep::firstMeeting(const Eigen::Vector3d& c,
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

}  // namespace tautline::planning
