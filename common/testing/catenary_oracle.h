#pragma once

/// @file
/// What common/catenary.h must agree with, computed without any of its formulas: the force balance
/// of a hanging tether, integrated numerically along the arc in extended precision. Tests only.

#include <array>
#include <cmath>

namespace tautline::testing {

struct TetherEnd {
  double r{};  ///< Horizontal reach [m].
  double h{};  ///< Height [m].
};

namespace detail {

using Real = long double;

struct Pair {
  Real r, h;
};

/// Sum of the unit tangents over [a, b] by 10-point Gauss-Legendre; s runs from D down to A.
template <class Tangent>
Pair gauss(const Tangent& tangent, Real a, Real b) {
  static constexpr std::array<Real, 5> kNode{
      0.148874338981631210884826L, 0.433395394129247190799266L, 0.679409568299024406234327L,
      0.865063366688984510732097L, 0.973906528517171720077964L};
  static constexpr std::array<Real, 5> kWeight{
      0.295524224714752870173815L, 0.269266719309996355091227L, 0.219086362515982043995535L,
      0.149451349150580593145863L, 0.066671344308688137593569L};
  const Real middle = (a + b) / 2;
  const Real half = (b - a) / 2;
  Pair sum{0, 0};
  for (std::size_t i = 0; i < kNode.size(); ++i) {
    for (const Real s : {middle - half * kNode[i], middle + half * kNode[i]}) {
      const Pair t = tangent(s);
      sum.r += half * kWeight[i] * t.r;
      sum.h += half * kWeight[i] * t.h;
    }
  }
  return sum;
}

template <class Tangent>
Pair adaptive(const Tangent& tangent, Real a, Real b, Real tolerance, int depth) {
  const Real middle = (a + b) / 2;
  const Pair whole = gauss(tangent, a, b);
  const Pair left = gauss(tangent, a, middle);
  const Pair right = gauss(tangent, middle, b);
  const Pair halves{left.r + right.r, left.h + right.h};
  if (depth == 0 ||
      std::fabs(whole.r - halves.r) + std::fabs(whole.h - halves.h) <= tolerance * (b - a)) {
    return halves;
  }
  const Pair l = adaptive(tangent, a, middle, tolerance, depth - 1);
  const Pair r = adaptive(tangent, middle, b, tolerance, depth - 1);
  return {l.r + r.r, l.h + r.h};
}

}  // namespace detail

/// Where D is relative to A, from arc length, tangent elevation and tension at D and the weight per
/// length: each piece of tether points along the force it carries, and that force loses w ds of its
/// vertical part on the way down.
[[nodiscard]] inline TetherEnd integrateTether(double L, double theta_D, double T_D, double w) {
  const detail::Real H = detail::Real(T_D) * std::cos(detail::Real(theta_D));
  const detail::Real V_D = detail::Real(T_D) * std::sin(detail::Real(theta_D));
  const detail::Real level = w > 0.0 ? V_D / detail::Real(w) : 0;
  // For H -> 0 the tether turns over within a very short length where it is level. Measuring s from
  // there keeps the digits of V, and splitting there keeps the steps honest.
  const bool from_level = w > 0.0 && std::fabs(level) < 2 * detail::Real(L);
  const detail::Real V_0 = from_level ? 0 : V_D;
  const detail::Real start = from_level ? -level : 0;
  const detail::Real end = start + detail::Real(L);
  const auto tangent = [&](detail::Real s) -> detail::Pair {
    const detail::Real V = V_0 - detail::Real(w) * s;
    const detail::Real T = std::hypot(H, V);
    return {H / T, V / T};
  };
  constexpr detail::Real kTolerance = 1e-16L;
  constexpr int kDepth = 70;
  detail::Pair sum{0, 0};
  const auto add = [&](detail::Real a, detail::Real b) {
    const detail::Pair part = detail::adaptive(tangent, a, b, kTolerance, kDepth);
    sum.r += part.r;
    sum.h += part.h;
  };
  if (start < 0 && end > 0) {
    add(start, 0);
    add(0, end);
  } else if (L > 0.0) {
    add(start, end);
  }
  return {static_cast<double>(sum.r), static_cast<double>(sum.h)};
}

}  // namespace tautline::testing
