#include "common/plot/thin.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

namespace tautline::plot {
namespace {

TEST(VisiblePoints, ATimeSeriesKeepsItsPeaksAndEnds) {
  std::vector<Point> points;
  for (int i = 0; i < 100000; ++i) points.push_back({i * 1e-3, std::sin(i * 0.01)});
  points[41234].y = 7.0;  // single samples that a plain "every n-th" would lose
  points[77777].y = -9.0;
  const auto kept = visiblePoints(points, 0.125, 0.01);
  const std::set<std::size_t> set(kept.begin(), kept.end());
  EXPECT_TRUE(set.contains(0));
  EXPECT_TRUE(set.contains(41234));
  EXPECT_TRUE(set.contains(77777));
  EXPECT_TRUE(set.contains(99999));
  EXPECT_LE(kept.size(), 4U * 801U);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
}

TEST(VisiblePoints, APathIsNeverFurtherThanAStepFromItsDrawing) {
  std::vector<Point> points;
  for (int i = 0; i <= 20000; ++i) {
    const double angle = i * 1e-3;
    points.push_back({std::cos(angle) * (1 + 0.01 * angle), std::sin(angle)});
  }
  const auto kept = visiblePoints(points, 0.01, 0.01);
  ASSERT_GE(kept.size(), 2U);
  EXPECT_LT(kept.size(), 4000U);
  EXPECT_EQ(kept.front(), 0U);
  EXPECT_EQ(kept.back(), 20000U);
  std::size_t k = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (k + 1 < kept.size() && kept[k + 1] <= i) ++k;
    EXPECT_LE(std::abs(points[i].x - points[kept[k]].x), 0.01);
    EXPECT_LE(std::abs(points[i].y - points[kept[k]].y), 0.01);
  }
}

TEST(VisiblePoints, BreaksStay) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto kept = visiblePoints({{0, 0}, {1e-9, 0}, {nan, nan}, {2e-9, 0}}, 1.0, 1.0);
  EXPECT_EQ(kept, (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_TRUE(visiblePoints({}, 1.0, 1.0).empty());
}

}  // namespace
}  // namespace tautline::plot
