#include "control/pole.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tautline {
namespace {

constexpr double kTiny = 1e-6;        ///< [m]: no direction can be taken from less.
constexpr double kEscapeShare = 0.6;  ///< Below this share of r_in the only way is out.

Eigen::Vector3d horizontal(const Eigen::Vector3d& v) noexcept { return {v.x(), 0.0, v.z()}; }

/// Outward unit vector at p, about the axis; +z on the axis itself, where toTether() has phi = 0.
Eigen::Vector3d outward(const Eigen::Vector3d& p_AD) noexcept {
  const Eigen::Vector3d p_h = horizontal(p_AD);
  const double r = p_h.norm();
  return r > kTiny ? Eigen::Vector3d(p_h / r) : Eigen::Vector3d::UnitZ();
}

/// Angle from the outward direction to the one to fly, by r = distance from the axis over r_in.
/// Outside: tangent to the cylinder. On it: along it. Deep inside, where the azimuth is worth
/// nothing: straight out.
double detourAngle(double r) noexcept {
  using std::numbers::pi;
  if (r >= 1.0) return pi - std::asin(1.0 / r);
  return 0.5 * pi * std::clamp((r - kEscapeShare) / (1.0 - kEscapeShare), 0.0, 1.0);
}

}  // namespace

PoleCylinder poleCylinder(const PoleConfig& config, const VehicleLimits& limits) noexcept {
  PoleCylinder out;
  out.speed = std::min(config.detour_speed_mps,
                       config.radius_max_m * limits.azimuth_rate_radps / config.rate_reserve);
  out.radius = config.rate_reserve * out.speed / limits.azimuth_rate_radps;
  out.outer_radius = out.radius + config.margin_m;
  return out;
}

double axisDistance(const Eigen::Vector3d& p_AD) noexcept { return std::hypot(p_AD.x(), p_AD.z()); }

Eigen::Vector3d PoleDetour::outsideGoal(const PoleCylinder& pole, const Eigen::Vector3d& p_AD,
                                        const Eigen::Vector3d& goal,
                                        const Eigen::Vector3d& heading) noexcept {
  const double goal_distance = axisDistance(goal);
  if (goal_distance >= pole.radius) return goal;
  const Eigen::Vector3d h = horizontal(heading);
  const double a = h.squaredNorm();
  if (a > 1e-4 * heading.squaredNorm()) {
    // Larger root of |goal_h + t h| = r_in; real, because the goal is inside.
    const double b = h.dot(goal);
    const double c = goal_distance * goal_distance - pole.radius * pole.radius;
    return goal + ((std::sqrt(b * b - a * c) - b) / a) * heading;
  }
  Eigen::Vector3d hover = pole.radius * outward(p_AD);
  hover.y() = goal.y();
  return hover;
}

Eigen::Vector3d PoleDetour::steer(const PoleCylinder& pole, const Eigen::Vector3d& p_AD,
                                  const Eigen::Vector3d& goal, double speed) noexcept {
  const Eigen::Vector3d way = goal - p_AD;
  const double distance = way.norm();
  if (distance < kTiny) return Eigen::Vector3d::Zero();
  const double r = axisDistance(p_AD);
  const Eigen::Vector3d e_r = outward(p_AD);
  const Eigen::Vector3d e_phi(e_r.z(), 0.0, -e_r.x());

  const Eigen::Vector3d way_h = horizontal(way);
  const double way_length = way_h.norm();
  const Eigen::Vector3d d_h = way_length > kTiny ? Eigen::Vector3d(way_h / way_length) : e_r;
  const double to_closest = -r * e_r.dot(d_h);  // way to go until the axis is closest; < 0: leaving
  const double miss = r * std::abs(e_phi.dot(d_h));
  const bool would_enter = to_closest > 0.0 && way_length > to_closest && miss < pole.radius;
  const bool too_deep = r < kEscapeShare * pole.radius;

  double v = speed;
  if (to_closest > 0.0 && miss < pole.outer_radius) {
    v = std::min(v, pole.speed + std::max(0.0, r - pole.radius) / config_.approach_time_s);
  }
  if (!too_deep && !(would_enter && r < pole.outer_radius)) {
    side_ = 0.0;
    return way * (v / distance);
  }
  v = std::min(v, pole.speed);
  if (side_ == 0.0) side_ = e_phi.dot(d_h) < 0.0 ? -1.0 : 1.0;
  const double angle = detourAngle(r / pole.radius);
  // Full speed in plan also on a steep path, or the detour would take for ever; height is tracked
  // beside it.
  return v * (std::cos(angle) * e_r + side_ * std::sin(angle) * e_phi) +
         (v * way.y() / distance) * Eigen::Vector3d::UnitY();
}

}  // namespace tautline
