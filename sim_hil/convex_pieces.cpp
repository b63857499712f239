#include "sim_hil/convex_pieces.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace tautline::sim {
namespace {

using Ring = std::vector<std::size_t>;  // indices into the polygon, counter-clockwise

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

double signedArea(const std::vector<Eigen::Vector2d>& polygon) {
  double area = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d& a = polygon[i];
    const Eigen::Vector2d& b = polygon[(i + 1) % polygon.size()];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return area;
}

bool isEar(const std::vector<Eigen::Vector2d>& p, const Ring& ring, std::size_t i) {
  const std::size_t a = ring[(i + ring.size() - 1) % ring.size()];
  const std::size_t b = ring[i];
  const std::size_t c = ring[(i + 1) % ring.size()];
  if (cross(p[a], p[b], p[c]) <= 0.0) return false;
  return std::none_of(ring.begin(), ring.end(), [&](std::size_t k) {
    return k != a && k != b && k != c && cross(p[a], p[b], p[k]) >= 0.0 &&
           cross(p[b], p[c], p[k]) >= 0.0 && cross(p[c], p[a], p[k]) >= 0.0;
  });
}

std::vector<Ring> triangles(const std::vector<Eigen::Vector2d>& p) {
  Ring ring(p.size());
  for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = i;
  std::vector<Ring> out;
  while (ring.size() > 3) {
    std::size_t ear = 0;
    while (ear < ring.size() && !isEar(p, ring, ear)) ++ear;
    if (ear == ring.size()) ear = 0;  // only rounding can lead here: all corners left are in line
    const std::size_t n = ring.size();
    out.push_back({ring[(ear + n - 1) % n], ring[ear], ring[(ear + 1) % n]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  out.push_back(ring);
  return out;
}

bool isConvex(const std::vector<Eigen::Vector2d>& p, const Ring& ring) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (cross(p[ring[i]], p[ring[(i + 1) % ring.size()]], p[ring[(i + 2) % ring.size()]]) < 0.0) {
      return false;
    }
  }
  return true;
}

/// The union of two rings that share a side, if it is convex.
std::optional<Ring> merged(const std::vector<Eigen::Vector2d>& p, const Ring& a, const Ring& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      if (a[i] != b[(k + 1) % b.size()] || a[(i + 1) % a.size()] != b[k]) continue;
      Ring ring;
      for (std::size_t n = 1; n <= a.size(); ++n) ring.push_back(a[(i + n) % a.size()]);
      for (std::size_t n = 2; n < b.size(); ++n) ring.push_back(b[(k + n) % b.size()]);
      if (isConvex(p, ring)) return ring;
      return std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<ConvexPiece> convexPieces(std::vector<Eigen::Vector2d> polygon) {
  if (signedArea(polygon) < 0.0) std::reverse(polygon.begin(), polygon.end());
  std::vector<Ring> rings = triangles(polygon);
  for (std::size_t a = 0; a < rings.size(); ++a) {
    for (std::size_t b = a + 1; b < rings.size(); ++b) {
      if (const auto ring = merged(polygon, rings[a], rings[b])) {
        rings[a] = *ring;
        rings.erase(rings.begin() + static_cast<std::ptrdiff_t>(b));
        b = a;  // start over with the grown piece
      }
    }
  }
  std::vector<ConvexPiece> pieces;
  for (const Ring& ring : rings) {
    ConvexPiece piece;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      piece.corner.push_back(polygon[ring[i]]);
      piece.inner.push_back((ring[i] + 1) % polygon.size() != ring[(i + 1) % ring.size()]);
    }
    pieces.push_back(piece);
  }
  return pieces;
}

}  // namespace tautline::sim
