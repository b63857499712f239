#pragma once

/// @file
/// What a count of failures says about their probability: the exact interval, and how well
/// predicted probabilities fit counts. Not real-time safe.

#include <cstdint>
#include <vector>

#include "common/plot/figure.h"

namespace tautline::experiments {

struct Interval {
  double low{0.0};
  double high{1.0};
};

/// P(X <= k) of a binomial X of n trials of probability p in [0, 1].
[[nodiscard]] double binomialCdf(std::int64_t k, std::int64_t n, double p);

/// The exact interval of Clopper and Pearson (Biometrika 26, 1934) for the probability, after k of
/// n trials: it holds the truth in at least `confidence` of all cases. 0 <= k <= n; n = 0 says
/// nothing: [0, 1].
[[nodiscard]] Interval clopperPearson(std::int64_t k, std::int64_t n, double confidence = 0.95);

/// A probability that was predicted, and what came of it.
struct Forecast {
  double predicted{0.0};  ///< Of failure, in [0, 1].
  std::int64_t failed{0};
  std::int64_t flights{0};
};

/// Mean of (predicted − outcome)² over all flights, outcome 1 for a failure (Brier 1950): 0 is
/// best, 0.25 is what "one half" always has. NaN without flights.
[[nodiscard]] double brierScore(const std::vector<Forecast>& forecasts);

/// Flights whose prediction is in one of the equal parts of [0, 1].
struct ReliabilityBin {
  double predicted{0.0};  ///< Mean over its flights.
  std::int64_t failed{0};
  std::int64_t flights{0};

  [[nodiscard]] double observed() const noexcept {
    return flights > 0 ? static_cast<double>(failed) / static_cast<double>(flights) : 0.0;
  }
};

/// Bins without flights are left out.
[[nodiscard]] std::vector<ReliabilityBin> reliability(const std::vector<Forecast>& forecasts,
                                                      int bins = 10);

/// Expected calibration error: |mean prediction − share of failures| of the bins, weighed by their
/// flights. NaN without flights.
[[nodiscard]] double calibrationError(const std::vector<Forecast>& forecasts, int bins = 10);

/// Share of failures over prediction with the interval of each bin, and the diagonal of a measure
/// that tells the truth.
[[nodiscard]] plot::Panel reliabilityPanel(const std::vector<Forecast>& forecasts,
                                           const std::string& title, plot::Colour colour);

}  // namespace tautline::experiments
