#include "app/experiments/binomial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.h"

namespace tautline::experiments {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kHalvings = 100;  // of an interval of length 1: down to the last bit

/// Smallest p at which `above(p)` holds; it holds from some p on.
template <class Predicate>
double firstWhere(Predicate above) {
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (above(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

double binomialCdf(std::int64_t k, std::int64_t n, double p) {
  if (k < 0) return 0.0;
  if (k >= n || p <= 0.0) return 1.0;
  if (p >= 1.0) return 0.0;
  const auto count = static_cast<double>(n);
  double sum = 0.0;
  for (std::int64_t i = 0; i <= k; ++i) {
    const auto x = static_cast<double>(i);
    sum += std::exp(std::lgamma(count + 1.0) - std::lgamma(x + 1.0) - std::lgamma(count - x + 1.0) +
                    x * std::log(p) + (count - x) * std::log1p(-p));
  }
  return std::min(sum, 1.0);
}

Interval clopperPearson(std::int64_t k, std::int64_t n, double confidence) {
  TAUTLINE_CHECK(k >= 0 && k <= n && confidence > 0.0 && confidence < 1.0);
  const double tail = 0.5 * (1.0 - confidence);
  Interval interval;
  if (n == 0) return interval;
  if (k > 0)
    interval.low = firstWhere([&](double p) { return 1.0 - binomialCdf(k - 1, n, p) >= tail; });
  if (k < n) interval.high = firstWhere([&](double p) { return binomialCdf(k, n, p) <= tail; });
  return interval;
}

double brierScore(const std::vector<Forecast>& forecasts) {
  double sum = 0.0;
  double flights = 0.0;
  for (const Forecast& f : forecasts) {
    const auto failed = static_cast<double>(f.failed);
    const auto all = static_cast<double>(f.flights);
    sum += failed * (1.0 - f.predicted) * (1.0 - f.predicted) +
           (all - failed) * f.predicted * f.predicted;
    flights += all;
  }
  return flights > 0.0 ? sum / flights : kNaN;
}

std::vector<ReliabilityBin> reliability(const std::vector<Forecast>& forecasts, int bins) {
  TAUTLINE_CHECK(bins > 0);
  std::vector<ReliabilityBin> all(static_cast<std::size_t>(bins));
  for (const Forecast& f : forecasts) {
    const int bin = std::clamp(static_cast<int>(f.predicted * bins), 0, bins - 1);
    ReliabilityBin& b = all[static_cast<std::size_t>(bin)];
    b.predicted += f.predicted * static_cast<double>(f.flights);
    b.failed += f.failed;
    b.flights += f.flights;
  }
  std::erase_if(all, [](const ReliabilityBin& b) { return b.flights == 0; });
  for (ReliabilityBin& b : all) b.predicted /= static_cast<double>(b.flights);
  return all;
}

double calibrationError(const std::vector<Forecast>& forecasts, int bins) {
  double sum = 0.0;
  double flights = 0.0;
  for (const ReliabilityBin& b : reliability(forecasts, bins)) {
    const auto weight = static_cast<double>(b.flights);
    sum += weight * std::abs(b.predicted - b.observed());
    flights += weight;
  }
  return flights > 0.0 ? sum / flights : kNaN;
}

plot::Panel reliabilityPanel(const std::vector<Forecast>& forecasts, const std::string& title,
                             plot::Colour colour) {
  plot::Panel panel;
  panel.title = title;
  panel.x = {.label = "predicted probability of failure", .limits = plot::Limits{0.0, 1.0}};
  panel.y = {.label = "share of flights that failed", .limits = plot::Limits{0.0, 1.0}};
  panel.series.push_back({.name = "the truth",
                          .points = {{0.0, 0.0}, {1.0, 1.0}},
                          .style = plot::Style::kDashed,
                          .colour = plot::Colour::kGrey});
  plot::Series paths{.name = "a path",
                     .style = plot::Style::kPoints,
                     .colour = plot::Colour::kLightGrey,
                     .width = 0.8};
  for (const Forecast& f : forecasts) {
    if (f.flights > 0)
      paths.points.push_back(
          {f.predicted, static_cast<double>(f.failed) / static_cast<double>(f.flights)});
  }
  plot::Series means{.name = "mean of a tenth",
                     .style = plot::Style::kPoints,
                     .colour = colour,
                     .symbol = plot::Symbol::kCircle};
  plot::Series bars{.name = "95 %", .colour = colour, .width = 1.0};
  for (const ReliabilityBin& b : reliability(forecasts)) {
    const Interval i = clopperPearson(b.failed, b.flights);
    means.points.push_back({b.predicted, b.observed()});
    bars.points.insert(bars.points.end(),
                       {{b.predicted, i.low}, {b.predicted, i.high}, {b.predicted, kNaN}});
  }
  panel.series.push_back(std::move(paths));
  panel.series.push_back(std::move(bars));
  panel.series.push_back(std::move(means));
  return panel;
}

}  // namespace tautline::experiments
