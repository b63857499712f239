#pragma once

/// @file
/// Fits a risk model to what came of flights. The cost of a path, −log(1 − risk), is the sum of its
/// elements' costs; a factor for each element is found by maximum likelihood. Not real-time safe.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace tautline::experiments {

/// A path: the costs that its risk is made of, and its flights.
struct CostOutcome {
  Eigen::VectorXd cost;  ///< One an element, >= 0; the same number in all rows.
  std::int64_t failed{0};
  std::int64_t flights{0};
};

/// 1 − exp(−factors · cost).
[[nodiscard]] double riskWith(const Eigen::VectorXd& factors, const Eigen::VectorXd& cost);

/// Log-likelihood of the flights: Σ f log(1 − e^{−a·c}) − (n − f) a·c. Concave in the factors a.
[[nodiscard]] double logLikelihood(const std::vector<CostOutcome>& paths,
                                   const Eigen::VectorXd& factors);

/// The one factor s for all elements together that makes the flights likeliest, between 1e-9 (none
/// failed) and 1e9 (all did).
[[nodiscard]] double fitScale(const std::vector<CostOutcome>& paths);

/// A factor a_k >= 0 for each element. Elements that always come together (every metre of way also
/// lengthens the tether) are kept apart by a weak preference for a common factor: what is maximized
/// is the log-likelihood − prior/2 · Σ (a_k / s − 1)², s = fitScale(). Newton's method on the
/// factors that are not at zero. Deterministic.
[[nodiscard]] Eigen::VectorXd fitFactors(const std::vector<CostOutcome>& paths, double prior = 1.0);

}  // namespace tautline::experiments
