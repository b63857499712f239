#include "common/prism.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tautline {
namespace {

using Polygon = std::span<const Eigen::Vector2d>;

bool isInside(const Eigen::Vector2d& p, Polygon polygon) noexcept {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) {
      inside = !inside;
    }
  }
  return inside;
}

double distanceToOutline(const Eigen::Vector2d& p, Polygon polygon) noexcept {
  double nearest = std::numeric_limits<double>::max();
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d edge = polygon[i] - polygon[j];
    const double t = std::clamp((p - polygon[j]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p - polygon[j] - t * edge).norm());
  }
  return nearest;
}

/// Where the line a + t d next crosses the outline after `t`, but not after `end`.
double nextCrossing(const Eigen::Vector2d& a, const Eigen::Vector2d& d, Polygon polygon, double t,
                    double end) noexcept {
  double next = end;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d edge = polygon[i] - polygon[j];
    const double determinant = cross(d, edge);
    if (determinant == 0.0) continue;
    const double crossing = cross(polygon[j] - a, edge) / determinant;
    if (crossing > t && crossing < next) next = crossing;
  }
  return next;
}

}  // namespace

bool clip(double p, double d, double lo, double hi, SegmentHit& hit) noexcept {
  if (d == 0.0) return p > lo && p < hi;
  const double t_lo = (lo - p) / d;
  const double t_hi = (hi - p) / d;
  hit.t_in = std::max(hit.t_in, std::min(t_lo, t_hi));
  hit.t_out = std::min(hit.t_out, std::max(t_lo, t_hi));
  return hit.t_in < hit.t_out;
}

std::optional<SegmentHit> intersect(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                                    const PrismView& prism) noexcept {
  SegmentHit slab{0.0, 1.0};
  if (!clip(p.y(), q.y() - p.y(), prism.y_min, prism.y_max, slab)) return std::nullopt;
  // Between two neighbouring crossings of the outline the line is wholly inside or wholly outside:
  // test the middle.
  const Eigen::Vector2d a = floorPoint(p);
  const Eigen::Vector2d d = floorPoint(q) - a;
  std::optional<SegmentHit> hit;
  for (double t = slab.t_in; t < slab.t_out;) {
    const double next = nextCrossing(a, d, prism.footprint, t, slab.t_out);
    if (isInside(a + 0.5 * (t + next) * d, prism.footprint)) {
      if (!hit) hit = SegmentHit{t, next};
      hit->t_out = next;
    } else if (hit) {
      break;
    }
    t = next;
  }
  return hit;
}

double signedDistance(const Eigen::Vector3d& p, const PrismView& prism) noexcept {
  const double outline = distanceToOutline(floorPoint(p), prism.footprint);
  const double across = isInside(floorPoint(p), prism.footprint) ? -outline : outline;
  const double along = std::max(prism.y_min - p.y(), p.y() - prism.y_max);
  return std::hypot(std::max(across, 0.0), std::max(along, 0.0)) +
         std::min(std::max(across, along), 0.0);
}

}  // namespace tautline
