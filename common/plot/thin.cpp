#include "common/plot/thin.h"

#include <algorithm>
#include <cmath>

namespace tautline::plot {
namespace {

bool isFinite(const Point& p) { return std::isfinite(p.x) && std::isfinite(p.y); }

// Points [begin, end) are finite with ascending x.
void keepColumns(const std::vector<Point>& points, std::size_t begin, std::size_t end,
                 double step_x, std::vector<std::size_t>& kept) {
  for (std::size_t first = begin; first < end;) {
    std::size_t low = first;
    std::size_t high = first;
    std::size_t next = first + 1;
    for (; next < end && points[next].x - points[first].x < step_x; ++next) {
      if (points[next].y < points[low].y) low = next;
      if (points[next].y > points[high].y) high = next;
    }
    for (const std::size_t i : {first, std::min(low, high), std::max(low, high), next - 1}) {
      if (kept.empty() || i > kept.back()) kept.push_back(i);
    }
    first = next;
  }
}

// Points [begin, end) are finite.
void keepMoves(const std::vector<Point>& points, std::size_t begin, std::size_t end, double step_x,
               double step_y, std::vector<std::size_t>& kept) {
  kept.push_back(begin);
  for (std::size_t i = begin + 1; i < end; ++i) {
    const Point& last = points[kept.back()];
    const bool moved =
        std::abs(points[i].x - last.x) >= step_x || std::abs(points[i].y - last.y) >= step_y;
    if (moved || i + 1 == end) kept.push_back(i);
  }
}

}  // namespace

std::vector<std::size_t> visiblePoints(const std::vector<Point>& points, double step_x,
                                       double step_y) {
  std::vector<std::size_t> kept;
  for (std::size_t begin = 0; begin < points.size();) {
    if (!isFinite(points[begin])) {
      kept.push_back(begin++);
      continue;
    }
    std::size_t end = begin + 1;
    bool ascending = true;
    for (; end < points.size() && isFinite(points[end]); ++end) {
      ascending = ascending && points[end].x >= points[end - 1].x;
    }
    if (ascending) {
      keepColumns(points, begin, end, step_x, kept);
    } else {
      keepMoves(points, begin, end, step_x, step_y, kept);
    }
    begin = end;
  }
  return kept;
}

}  // namespace tautline::plot
