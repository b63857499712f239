#pragma once

/// @file
/// Numeric derivatives for tests: the oracle against which closed-form Jacobians are checked. Tests
/// only.

#include <cmath>

#include <Eigen/Core>

namespace tautline::testing {

/// Central differences of `f` at `x`, with one Richardson step: error O(step^4) plus rounding of
/// about epsilon |f| / step. `f` takes Eigen::Matrix<double, N, 1> and returns
/// Eigen::Matrix<double, M, 1>.
template <int M, int N, class Function>
[[nodiscard]] Eigen::Matrix<double, M, N> numericJacobian(const Function& f,
                                                          const Eigen::Matrix<double, N, 1>& x,
                                                          double relative_step = 1e-4) {
  using Input = Eigen::Matrix<double, N, 1>;
  using Output = Eigen::Matrix<double, M, 1>;
  Eigen::Matrix<double, M, N> J;
  for (Eigen::Index i = 0; i < N; ++i) {
    const auto difference = [&](double step) -> Output {
      Input below = x;
      Input above = x;
      below(i) -= step;
      above(i) += step;
      return (Output(f(above)) - Output(f(below))) / (above(i) - below(i));
    };
    const double step = relative_step * std::fmax(1.0, std::abs(x(i)));
    J.col(i) = (4.0 * difference(step / 2.0) - difference(step)) / 3.0;
  }
  return J;
}

}  // namespace tautline::testing
