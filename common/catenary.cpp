#include "common/catenary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tautline {
namespace {

constexpr double kHalfPi = std::numbers::pi / 2.0;

// atanh(q)/q for q in [0, 1), with 1 - q given separately because it carries the digits near q = 1.
double atanhOverQ(double q, double one_minus_q) noexcept {
  if (q < 0.05) {
    const double q2 = q * q;  // next term q^12/13 < 2e-17
    return 1.0 + q2 * (1.0 / 3 + q2 * (1.0 / 5 + q2 * (1.0 / 7 + q2 * (1.0 / 9 + q2 / 11))));
  }
  return 0.5 * std::log1p(2.0 * q / one_minus_q) / q;
}

// sinh(u)/u and its derivative.
struct SinhRatio {
  double value, slope;
};
SinhRatio sinhOverU(double u) noexcept {
  if (u < 0.2) {
    const double u2 = u * u;  // next relative terms below 1e-17
    return {1.0 + u2 / 6 * (1.0 + u2 / 20 * (1.0 + u2 / 42 * (1.0 + u2 / 72 * (1.0 + u2 / 110)))),
            u / 3 * (1.0 + u2 / 10 * (1.0 + u2 / 28 * (1.0 + u2 / 54 * (1.0 + u2 / 88))))};
  }
  const double s = std::sinh(u);
  return {s / u, (std::cosh(u) - s / u) / u};
}

// One member of the family of segments through (r, h), by u = w r / (2H): its arc length, and 2
// T_end / w with its slope.
struct Member {
  double L, tension, tension_slope;
};
Member memberThrough(double r, double signed_h, double u) noexcept {
  const auto [s, s_slope] = sinhOverU(u);
  const double h = std::abs(signed_h);
  const double L = std::hypot(h, r * s);
  const double coth_minus_1 = 2.0 / std::expm1(2.0 * u);
  const double coth = 1.0 + coth_minus_1;
  // L coth u + signed_h, without the cancellation of L - |h|.
  const double tension =
      signed_h >= 0.0 ? L * coth + h : r * s * (r * s / (L + h)) + L * coth_minus_1;
  const double L_slope = r * s / L * (r * s_slope);
  const double coth_slope = -coth_minus_1 * (2.0 + coth_minus_1);  // -1/sinh^2
  return {L, tension, L_slope * coth + L * coth_slope};
}

// The u of the least tension through (r, h), k = |h|/r: root of psi(u) = s^2 sinh^2(u) (1 -
// coth(u)/u) = k^2, eq. (10). Newton on log(1 + psi), which is nearly linear in u.
double slackestU(double k) noexcept {
  constexpr double kLevel = 1.1996786402577338;  // u tanh u = 1: the root for h = 0
  constexpr int kMaxSteps = 60;
  const double target = std::log1p(k * k);
  double u = kLevel + 0.25 * target;
  for (int i = 0; i < kMaxSteps; ++i) {
    const double sinh_u = std::sinh(u);
    const double cosh_u = std::cosh(u);
    const double a = sinh_u / u;                      // psi = a^2 b
    const double b = sinh_u * (sinh_u - cosh_u / u);  // sinh^2 (1 - coth/u)
    const double a_slope = (cosh_u - a) / u;
    const double b_slope =
        cosh_u * (sinh_u - cosh_u / u) + sinh_u * (cosh_u - sinh_u / u + cosh_u / (u * u));
    const double psi = a * a * b;
    const double slope = (2.0 * a * a_slope * b + a * a * b_slope) / (1.0 + psi);
    const double step = (std::log1p(psi) - target) / slope;
    u = std::max(kLevel, u - step);
    if (std::abs(step) <= 1e-15 * u) break;
  }
  return u;
}

bool inverseDomain(double r, double h, double w) noexcept {
  return std::isfinite(r) && r >= 0.0 && std::isfinite(h) && std::isfinite(w) && w >= 0.0;
}

// So steep that the horizontal force no longer shows in the shape: straight and vertical.
bool isVertical(double r, double h) noexcept { return r <= 1e-60 * std::abs(h); }

}  // namespace

CatenarySolution solveCatenary(const CatenaryInput& in, CatenaryJacobian* jacobian) noexcept {
  // Written so that NaN fails every test.
  const bool valid = std::isfinite(in.L) && in.L >= 0.0 && std::abs(in.theta_D) <= kHalfPi &&
                     std::isfinite(in.T_D) && in.T_D > 0.0 && std::isfinite(in.w) && in.w >= 0.0;
  if (!valid) return {};

  CatenarySolution out;
  const double L = in.L;
  const double c_theta = std::cos(in.theta_D);
  const double s_theta = std::sin(in.theta_D);
  out.H = in.T_D * c_theta;  // (5)
  out.V_D = in.T_D * s_theta;
  out.V_A = out.V_D - in.w * L;
  out.T_A = std::hypot(out.H, out.V_A);
  const double S = in.T_D + out.T_A;
  const double q = in.w * L / S;
  // Conjugate forms: T - V = H^2/(T + V) keeps the digits of a segment that hangs nearly straight
  // down at both ends.
  const double T_minus_V_D =
      s_theta > 0.0 ? out.H * (out.H / (in.T_D + out.V_D)) : in.T_D - out.V_D;
  const double T_plus_V_A =
      out.V_A < 0.0 ? out.H * (out.H / (out.T_A - out.V_A)) : out.T_A + out.V_A;
  const double one_minus_q = (T_minus_V_D + T_plus_V_A) / S;
  const double r_over_H = one_minus_q > 0.0 ? 2.0 * L / S * atanhOverQ(q, one_minus_q) : 0.0;

  out.h = L * ((out.V_A + out.V_D) / S);  // (6)
  out.r = out.H * r_over_H;               // (7)
  out.chord = std::hypot(out.r, out.h);
  out.chord_elevation = out.chord > 0.0 ? std::atan2(out.h, out.r) : in.theta_D;
  out.theta_A = std::atan2(out.V_A, out.H);
  out.dips_below_anchor = out.V_A < 0.0;
  out.ok = std::isfinite(out.r) && std::isfinite(out.h);

  if (jacobian != nullptr) {  // (8)
    const double T_A = std::max(out.T_A, std::numeric_limits<double>::min());
    const double c = -(out.H / in.T_D) * (out.h / T_A);  // dr/dV_D = dh/dH
    const double D = one_minus_q > 0.0
                         ? 2.0 * L / S / (1.0 + q) * (out.H / in.T_D) * (out.H / T_A) / one_minus_q
                         : 0.0;  // dh/dV_D
    const double dr_dH = r_over_H - D;
    *jacobian << out.H / T_A, -dr_dH * out.V_D + c * out.H, dr_dH * c_theta + c * s_theta,  //
        out.V_A / T_A, -c * out.V_D + D * out.H, c * c_theta + D * s_theta;
  }
  return out;
}

double minimumTension(double r, double h, double w, TensionEnd end) noexcept {
  if (!inverseDomain(r, h, w)) return 0.0;
  const double signed_h = end == TensionEnd::kDrone ? h : -h;
  if (isVertical(r, h)) return w * std::max(0.0, signed_h);
  return 0.5 * w * memberThrough(r, signed_h, slackestU(std::abs(h) / r)).tension;
}

CatenaryInverse solveInverseCatenary(double r, double h, double T, double w,
                                     TensionEnd end) noexcept {
  if (!inverseDomain(r, h, w) || !std::isfinite(T) || !(T > 0.0)) return {};

  CatenaryInverse out;
  const double chord = std::hypot(r, h);
  const double signed_h = end == TensionEnd::kDrone ? h : -h;
  const bool vertical = isVertical(r, h);
  const double slackest_u = vertical ? 0.0 : slackestU(std::abs(h) / r);
  out.T_min = vertical ? w * std::max(0.0, signed_h)
                       : 0.5 * w * memberThrough(r, signed_h, slackest_u).tension;
  if (T < out.T_min) {
    out.status = CatenaryStatus::kNotReachable;
    return out;
  }
  out.status = CatenaryStatus::kOk;
  out.T_D = end == TensionEnd::kDrone ? T : T + w * h;
  out.T_A = end == TensionEnd::kDrone ? T - w * h : T;

  if (vertical || w * chord <= 1e-16 * T) {  // straight to the last digit
    out.L = chord;
    out.theta_D = out.theta_A = chord > 0.0 ? std::atan2(h, r) : 0.0;
    out.H = T * std::cos(out.theta_D);
    out.dips_below_anchor = out.theta_A < 0.0;
    return out;
  }

  // (9): the tension falls with u up to slackest_u, and u0 is left of the root since L >= chord and
  // coth u >= 1/u.
  constexpr int kMaxSteps = 80;
  const double tension = 2.0 * T / w;
  double u = std::min(slackest_u, chord / (tension - signed_h));
  for (int i = 0; i < kMaxSteps; ++i) {
    const Member m = memberThrough(r, signed_h, u);
    if (m.tension_slope >= 0.0) break;  // at the slackest member: T = T_min
    const double step = (tension - m.tension) / m.tension_slope;
    u = std::min(slackest_u, u + step);
    if (!(step > 1e-15 * u)) break;  // the root, or as near as rounding lets us come
  }
  out.L = memberThrough(r, signed_h, u).L;
  const double coth = 1.0 / std::tanh(u);
  out.H = 0.5 * w * r / u;
  const double V_A = 0.5 * w * (h * coth - out.L);
  out.theta_D = std::atan2(0.5 * w * (h * coth + out.L), out.H);
  out.theta_A = std::atan2(V_A, out.H);
  out.dips_below_anchor = V_A < 0.0;
  return out;
}

ReelTension tensionFromReel(double T_reel, double L, double theta_D, double w,
                            double capstan_factor) noexcept {
  const bool valid = std::isfinite(T_reel) && T_reel > 0.0 && std::isfinite(L) && L >= 0.0 &&
                     std::abs(theta_D) <= kHalfPi && std::isfinite(w) && w >= 0.0 &&
                     std::isfinite(capstan_factor) && capstan_factor > 0.0;
  if (!valid) return {};
  const double T_A = T_reel * capstan_factor;
  const double weight = w * L;
  const double across = weight * std::cos(theta_D);
  if (T_A < across) return {};
  const double T_D =
      weight * std::sin(theta_D) + std::sqrt((T_A - across) * (T_A + across));  // (11)
  return {.ok = T_D > 0.0, .T_D = T_D};
}

}  // namespace tautline
