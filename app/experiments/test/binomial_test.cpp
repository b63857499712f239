#include "app/experiments/binomial.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tautline::experiments {
namespace {

/// Of tables of the exact interval, 95 %.
TEST(ClopperPearson, TabulatedValues) {
  struct Row {
    int k, n;
    double low, high;
  };
  constexpr std::array rows{Row{0, 10, 0.0, 0.3085},    Row{2, 10, 0.0252, 0.5561},
                            Row{4, 10, 0.1216, 0.7376}, Row{10, 10, 0.6915, 1.0},
                            Row{1, 1, 0.025, 1.0},      Row{5, 100, 0.0164, 0.1128}};
  for (const Row& row : rows) {
    const Interval i = clopperPearson(row.k, row.n);
    EXPECT_NEAR(i.low, row.low, 5e-5) << row.k << " of " << row.n;
    EXPECT_NEAR(i.high, row.high, 5e-5) << row.k << " of " << row.n;
  }
}

TEST(ClopperPearson, WithoutTrialsSaysNothing) {
  const Interval i = clopperPearson(0, 0);
  EXPECT_EQ(i.low, 0.0);
  EXPECT_EQ(i.high, 1.0);
}

/// What the interval is defined by, also for many trials: each tail has 2.5 %.
TEST(ClopperPearson, TailsAtItsEnds) {
  for (const std::int64_t k : {1, 137, 5000, 9999}) {
    const Interval i = clopperPearson(k, 10000);
    EXPECT_NEAR(1.0 - binomialCdf(k - 1, 10000, i.low), 0.025, 1e-8);
    EXPECT_NEAR(binomialCdf(k, 10000, i.high), 0.025, 1e-8);
  }
}

/// It holds the truth in at least 95 % of all counts, whatever the truth is.
TEST(ClopperPearson, Covers) {
  constexpr int kTrials = 30;
  for (const double p : {0.01, 0.2, 0.5, 0.83}) {
    double covered = 0.0;
    for (int k = 0; k <= kTrials; ++k) {
      const Interval i = clopperPearson(k, kTrials);
      if (i.low <= p && p <= i.high)
        covered += binomialCdf(k, kTrials, p) - binomialCdf(k - 1, kTrials, p);
    }
    EXPECT_GE(covered, 0.95);
  }
}

TEST(Brier, OfSimpleForecasts) {
  EXPECT_DOUBLE_EQ(brierScore({{1.0, 3, 3}, {0.0, 0, 7}}), 0.0);
  EXPECT_DOUBLE_EQ(brierScore({{0.5, 1, 4}}), 0.25);
  EXPECT_DOUBLE_EQ(brierScore({{0.2, 1, 4}}), (0.64 + 3 * 0.04) / 4);
  EXPECT_TRUE(std::isnan(brierScore({})));
}

TEST(CalibrationError, IsZeroForTheTruthAndWeighsByFlights) {
  EXPECT_NEAR(calibrationError({{0.25, 25, 100}, {0.75, 75, 100}}), 0.0, 1e-15);
  // Off by 0.5 in a quarter of the flights.
  EXPECT_NEAR(calibrationError({{0.25, 75, 100}, {0.85, 255, 300}}), 0.125, 1e-15);
}

TEST(Reliability, BinsHoldTheirFlights) {
  const auto bins = reliability({{0.11, 1, 10}, {0.19, 3, 30}, {1.0, 5, 5}}, 10);
  ASSERT_EQ(bins.size(), 2U);
  EXPECT_EQ(bins[0].flights, 40);
  EXPECT_EQ(bins[0].failed, 4);
  EXPECT_NEAR(bins[0].predicted, (0.11 * 10 + 0.19 * 30) / 40, 1e-15);
  EXPECT_EQ(bins[1].flights, 5);
}

}  // namespace
}  // namespace tautline::experiments
