#include "planning_offline/tether/edge_equilibrium.h"

#include <algorithm>
#include <cmath>

namespace tautline::planning {
namespace {

constexpr double kNearest = 1e-9;  // points nearer than this count as this far apart

double distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::max((b - a).norm(), kNearest);
}

/// Newton's equations of the points' ways: a symmetric tridiagonal system, diagonal and what is
/// above it.
struct Equations {
  std::vector<double> diagonal;
  std::vector<double> above;
  std::vector<double> gradient;
};

/// One row a point. Points at an end of their stretch that pulls them outwards are left out.
void build(const Eigen::Vector3d& a, const Eigen::Vector3d& b, std::span<const SlidingPoint> points,
           Equations& out) {
  const std::size_t n = points.size();
  out.diagonal.assign(n, 0.0);
  out.above.assign(n, 0.0);
  out.gradient.assign(n, 0.0);
  for (std::size_t i = 0; i <= n; ++i) {  // the piece before point i
    const Eigen::Vector3d& from = i > 0 ? points[i - 1].at : a;
    const Eigen::Vector3d& to = i < n ? points[i].at : b;
    const double d = distance(from, to);
    const Eigen::Vector3d t = (to - from) / d;
    const auto add = [&](std::size_t k, double sign) {
      const double along = t[points[k].axis];
      out.gradient[k] += sign * along;
      out.diagonal[k] += (1.0 - along * along) / d;
    };
    if (i > 0) add(i - 1, -1.0);
    if (i < n) add(i, 1.0);
    if (i > 0 && i < n) {
      const int p = points[i - 1].axis;
      const int q = points[i].axis;
      out.above[i - 1] = -((p == q ? 1.0 : 0.0) - t[p] * t[q]) / d;
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    const SlidingPoint& point = points[i];
    const double at = point.at[point.axis];
    const bool held =
        (at <= point.low && out.gradient[i] > 0.0) || (at >= point.high && out.gradient[i] < 0.0);
    if (!held) continue;
    out.gradient[i] = 0.0;
    out.diagonal[i] = 1.0;
    out.above[i] = 0.0;
    if (i > 0) out.above[i - 1] = 0.0;
  }
}

/// Solves them; the step takes the gradient's place.
void solve(Equations& e) {
  constexpr double kLeast = 1e-12;  // of a diagonal: a piece along the axis has none
  const std::size_t n = e.gradient.size();
  for (std::size_t i = 0; i < n; ++i) {
    e.gradient[i] = -e.gradient[i];
    if (i > 0) {
      const double factor = e.above[i - 1] / e.diagonal[i - 1];
      e.diagonal[i] -= factor * e.above[i - 1];
      e.gradient[i] -= factor * e.gradient[i - 1];
    }
    e.diagonal[i] = std::max(e.diagonal[i], kLeast);
  }
  for (std::size_t i = n; i-- > 0;) {
    const double next = i + 1 < n ? e.above[i] * e.gradient[i + 1] : 0.0;
    e.gradient[i] = (e.gradient[i] - next) / e.diagonal[i];
  }
}

double lengthOf(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                std::span<const SlidingPoint> points) {
  double length = 0.0;
  Eigen::Vector3d last = a;
  for (const SlidingPoint& point : points) {
    length += (point.at - last).norm();
    last = point.at;
  }
  return length + (b - last).norm();
}

}  // namespace

double slope(const Eigen::Vector3d& a, const Eigen::Vector3d& at, int axis,
             const Eigen::Vector3d& b) noexcept {
  return (at[axis] - a[axis]) / distance(a, at) - (b[axis] - at[axis]) / distance(at, b);
}

void findEquilibrium(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                     std::span<SlidingPoint> points) {
  constexpr int kStepsMax = 60;
  constexpr double kStill = 1e-10;
  constexpr double kRounding = 1e-15;  // of the length
  for (SlidingPoint& point : points) {
    point.at[point.axis] = std::clamp(point.at[point.axis], point.low, point.high);
  }
  Equations equations;
  std::vector<double> start(points.size());
  double length = lengthOf(a, b, points);
  for (int step = 0; step < kStepsMax; ++step) {
    build(a, b, points, equations);
    solve(equations);
    for (std::size_t i = 0; i < points.size(); ++i) start[i] = points[i].at[points[i].axis];
    double moved = 0.0;
    double shorter = length;
    for (double part = 1.0; part > 1e-9; part *= 0.5) {
      moved = 0.0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        SlidingPoint& point = points[i];
        const double to = start[i] + part * equations.gradient[i];
        point.at[point.axis] = std::clamp(to, point.low, point.high);
        moved = std::max(moved, std::abs(point.at[point.axis] - start[i]));
      }
      shorter = lengthOf(a, b, points);
      if (shorter <= length * (1.0 + kRounding)) break;
    }
    length = shorter;
    if (moved < kStill) return;
  }
}

}  // namespace tautline::planning
