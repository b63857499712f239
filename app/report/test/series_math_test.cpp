#include "app/report/series_math.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace tautline::report {
namespace {

TEST(SeriesMath, SummaryOfTheFirstHundredNumbers) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  values.push_back(std::numeric_limits<double>::quiet_NaN());
  const auto s = summarize(values);
  ASSERT_TRUE(s);
  EXPECT_EQ(s->count, 100U);
  EXPECT_NEAR(s->mean, 50.5, 1e-12);
  EXPECT_NEAR(s->rms, std::sqrt(101.0 * 201.0 / 6.0), 1e-12);  // sum of squares n(n+1)(2n+1)/6
  EXPECT_EQ(s->max, 100.0);
  EXPECT_EQ(s->p95, 95.0);
  EXPECT_FALSE(summarize({}));
  EXPECT_EQ(summarize({7.0})->p95, 7.0);
}

TEST(SeriesMath, SlopeOfALineAndOfNothing) {
  EXPECT_NEAR(slope({1, 2, 4, 8}, {5, 7, 11, 19}).value(), 2.0, 1e-12);
  EXPECT_NEAR(slope({0, 1, 2, 3}, {1, -1, -1, 1}).value(), 0.0, 1e-12);
  EXPECT_FALSE(slope({3, 3, 3}, {1, 2, 3}));
  EXPECT_FALSE(slope({3}, {1}));
}

TEST(SeriesMath, DistanceToSegmentAgainstBruteForce) {
  const std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {1, 2, -1}, {3, 0.5, 0.2}, {-2, 1, 1}};
  for (const auto& a : corners) {
    for (const auto& b : corners) {
      for (const auto& p : corners) {
        double best = std::numeric_limits<double>::max();
        for (int i = 0; i <= 20000; ++i)
          best = std::min(best, (p - (a + i / 20000.0 * (b - a))).norm());
        EXPECT_NEAR(distanceToSegment(p, a, b), best, 1e-4);
      }
    }
  }
}

TEST(SeriesMath, InterpolationNeverInvents) {
  const std::vector<PositionSample> line{{1.0, {0, 0, 0}}, {2.0, {10, 0, -4}}, {9.0, {0, 0, 0}}};
  EXPECT_TRUE(interpolate(line, 1.25, 1.5)->isApprox(Eigen::Vector3d(2.5, 0, -1)));
  EXPECT_TRUE(interpolate(line, 2.0, 1.5)->isApprox(Eigen::Vector3d(10, 0, -4)));
  EXPECT_TRUE(interpolate(line, 9.0, 1.5)->isZero());
  EXPECT_FALSE(interpolate(line, 0.999, 1.5));
  EXPECT_FALSE(interpolate(line, 9.001, 1.5));
  EXPECT_FALSE(interpolate(line, 5.0, 1.5)) << "a hole of 7 s";
  EXPECT_FALSE(interpolate({}, 5.0, 1.5));
}

TEST(SeriesMath, SignChangesIgnoreTheDeadBand) {
  EXPECT_EQ(countSignChanges({1, -1, 1, -1}, 0.1), 3);
  EXPECT_EQ(countSignChanges({1, 0, 0.05, 2, -0.05, 3}, 0.1), 0);
  EXPECT_EQ(countSignChanges({0, 0, -1, 0, 1}, 0.1), 1);
  EXPECT_EQ(countSignChanges({}, 0.1), 0);
}

}  // namespace
}  // namespace tautline::report
