#include "app/experiments/risk_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "common/error.h"

namespace tautline::experiments {
namespace {

constexpr double kLeastCost = 1e-12;  // of a path that failed: its logarithm is finite
constexpr int kMaxSteps = 200;
constexpr double kEnough = 1e-12;  // relative gain of a step

double costWith(const Eigen::VectorXd& factors, const Eigen::VectorXd& cost) {
  return std::max(factors.dot(cost), kLeastCost);
}

/// Likelihood with the preference for a common factor, its gradient and minus its Hessian.
class Posterior {
 public:
  Posterior(const std::vector<CostOutcome>& paths, double scale, double prior)
      : paths_(paths), scale_(scale), prior_(prior) {}

  [[nodiscard]] double value(const Eigen::VectorXd& a) const {
    return logLikelihood(paths_, a) -
           0.5 * prior_ * ((a / scale_).array() - 1.0).matrix().squaredNorm();
  }
  void derive(const Eigen::VectorXd& a, Eigen::VectorXd& gradient,
              Eigen::MatrixXd& curvature) const {
    gradient = -prior_ / scale_ * ((a / scale_).array() - 1.0).matrix();
    curvature = Eigen::MatrixXd::Identity(a.size(), a.size()) * (prior_ / (scale_ * scale_));
    for (const CostOutcome& p : paths_) {
      const double c = costWith(a, p.cost);
      const auto failed = static_cast<double>(p.failed);
      const auto fine = static_cast<double>(p.flights - p.failed);
      const double odds = 1.0 / std::expm1(c);  // (1 − risk) / risk
      gradient += (failed * odds - fine) * p.cost;
      curvature += failed * odds * (1.0 + odds) * p.cost * p.cost.transpose();
    }
  }

 private:
  const std::vector<CostOutcome>& paths_;
  double scale_;
  double prior_;
};

/// Newton's step of the factors that may move; the others stay at zero.
Eigen::VectorXd newtonStep(const Eigen::VectorXd& a, const Eigen::VectorXd& gradient,
                           const Eigen::MatrixXd& curvature) {
  Eigen::VectorXd g = gradient;
  Eigen::MatrixXd h = curvature;
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    if (a[k] > 0.0 || gradient[k] > 0.0) continue;
    g[k] = 0.0;
    h.row(k).setZero();
    h.col(k).setZero();
    h(k, k) = 1.0;
  }
  return h.ldlt().solve(g);
}

}  // namespace

double riskWith(const Eigen::VectorXd& factors, const Eigen::VectorXd& cost) {
  return -std::expm1(-factors.dot(cost));
}

double logLikelihood(const std::vector<CostOutcome>& paths, const Eigen::VectorXd& factors) {
  double sum = 0.0;
  for (const CostOutcome& p : paths) {
    const double c = costWith(factors, p.cost);
    sum += static_cast<double>(p.failed) * std::log(-std::expm1(-c)) -
           static_cast<double>(p.flights - p.failed) * c;
  }
  return sum;
}

double fitScale(const std::vector<CostOutcome>& paths) {
  TAUTLINE_CHECK(!paths.empty());
  // The derivative of the likelihood falls with the scale: halving finds its zero.
  const auto rises = [&](double scale) {
    double slope = 0.0;
    for (const CostOutcome& p : paths) {
      const double c = p.cost.sum();
      if (c <= 0.0) continue;
      slope += c * (static_cast<double>(p.failed) / std::expm1(scale * c) -
                    static_cast<double>(p.flights - p.failed));
    }
    return slope > 0.0;
  };
  double low = 1e-9;
  double high = 1e9;
  for (int i = 0; i < 200; ++i) {
    const double middle = std::sqrt(low * high);
    (rises(middle) ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

Eigen::VectorXd fitFactors(const std::vector<CostOutcome>& paths, double prior) {
  const double scale = fitScale(paths);
  const Posterior posterior(paths, scale, prior);
  Eigen::VectorXd a = Eigen::VectorXd::Constant(paths.front().cost.size(), scale);
  double value = posterior.value(a);
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;
  for (int step = 0; step < kMaxSteps; ++step) {
    posterior.derive(a, gradient, curvature);
    const Eigen::VectorXd newton = newtonStep(a, gradient, curvature);
    double gain = 0.0;
    for (double length = 1.0; length > 1e-9 && gain <= 0.0; length *= 0.5) {
      const Eigen::VectorXd next = (a + length * newton).cwiseMax(0.0);
      gain = posterior.value(next) - value;
      if (gain > 0.0) a = next;
    }
    if (gain <= kEnough * std::abs(value)) break;
    value += gain;
  }
  return a;
}

}  // namespace tautline::experiments
