#include "estimation/position_fix.h"

#include <cmath>
#include <numbers>

#include "common/catenary.h"
#include "common/tether_geometry.h"

namespace tautline {
namespace {

PositionFix fixAt(double L, double theta, double phi) noexcept {
  PositionFix fix{.ok = true, .p_AD = toCartesian({L, theta, phi})};
  fix.ok = fix.p_AD.allFinite();
  return fix.ok ? fix : PositionFix{};
}

}  // namespace

PublishedCatenary publishedCatenary(double theta, double T_0, double w) noexcept {
  const double t = std::tan(theta);
  const double a = T_0 / w;
  const double x = std::asinh(t);
  const double y =
      t * std::tan(theta / 2.0);  // sec(theta) - 1 = cosh(L_x/a) - 1, without cancellation
  PublishedCatenary out;          // (14)
  out.theta_r = x == 0.0 ? 0.0 : std::atan(y / x);
  out.L_x = a * x;
  out.L_y = a * y;
  out.L_r = a * std::hypot(x, y);
  out.L_s = a * t;
  return out;
}

PositionFix fixPosition(FixVariant variant, const FixInput& in) noexcept {
  constexpr double kHalfPi = std::numbers::pi / 2.0;
  const bool valid =
      std::isfinite(in.L) && in.L >= 0.0 && std::abs(in.theta) <= kHalfPi && std::isfinite(in.phi);
  if (!valid) return {};
  switch (variant) {
    case FixVariant::kStraight:
      return fixAt(in.L, in.theta, in.phi);
    case FixVariant::kExact: {
      const CatenarySolution segment = solveCatenary({in.L, in.theta, in.T, in.w});
      return segment.ok ? fixAt(segment.chord, segment.chord_elevation, in.phi) : PositionFix{};
    }
    case FixVariant::kAsPublishedCode:
      return fixAt(in.L, publishedCatenary(in.theta, 1.0, 1.0).theta_r, in.phi);
    case FixVariant::kAsPublishedText: {
      if (!(in.T > 0.0) || !(in.w > 0.0)) return {};
      const PublishedCatenary model = publishedCatenary(in.theta, in.T, in.w);
      return fixAt(model.L_r, model.theta_r, in.phi);
    }
  }
  return {};
}

}  // namespace tautline
