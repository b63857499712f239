#include "app/report/series_math.h"

#include <cmath>

namespace tautline::report {

std::optional<Summary> summarize(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  Summary out{.count = values.size(), .mean = 0.0, .rms = 0.0, .max = values.back(), .p95 = 0.0};
  for (const double v : values) {
    out.mean += v / n;
    out.rms += v * v / n;
  }
  out.rms = std::sqrt(out.rms);
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * n));
  out.p95 = values[std::max<std::size_t>(rank, 1) - 1];
  return out;
}

std::optional<double> slope(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<Eigen::Index>(std::min(x.size(), y.size()));
  if (n < 2) return std::nullopt;
  const Eigen::Map<const Eigen::ArrayXd> xs(x.data(), n);
  const Eigen::Map<const Eigen::ArrayXd> ys(y.data(), n);
  const Eigen::ArrayXd dx = xs - xs.mean();
  const double variance = dx.square().sum();
  constexpr double kSameWithin = 1e-9;  // [m], times the number of samples
  if (!(variance > kSameWithin * kSameWithin * static_cast<double>(n))) return std::nullopt;
  return (dx * (ys - ys.mean())).sum() / variance;
}

double distanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b) {
  const Eigen::Vector3d ab = b - a;
  const double length_squared = ab.squaredNorm();
  const double s =
      length_squared > 0.0 ? std::clamp(ab.dot(p - a) / length_squared, 0.0, 1.0) : 0.0;
  return (p - (a + s * ab)).norm();
}

std::optional<Eigen::Vector3d> interpolate(const std::vector<PositionSample>& series, double t,
                                           double max_gap) {
  const auto after =
      std::lower_bound(series.begin(), series.end(), t,
                       [](const PositionSample& s, double time) { return s.t < time; });
  if (after == series.end()) return std::nullopt;
  if (after->t == t) return after->p;
  if (after == series.begin()) return std::nullopt;
  const auto before = after - 1;
  if (after->t - before->t > max_gap) return std::nullopt;
  const double s = (t - before->t) / (after->t - before->t);
  return before->p + s * (after->p - before->p);
}

int countSignChanges(const std::vector<double>& values, double dead_band) {
  int changes = 0;
  int last_sign = 0;
  for (const double v : values) {
    if (!(std::abs(v) > dead_band)) continue;
    const int sign = v > 0.0 ? 1 : -1;
    if (last_sign != 0 && sign != last_sign) ++changes;
    last_sign = sign;
  }
  return changes;
}

}  // namespace tautline::report
