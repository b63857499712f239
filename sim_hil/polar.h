#pragma once

/// @file
/// Direction of the tether by elevation and azimuth, W axes (docs/tether_model.md, eqs 1 and 2).
/// The simulator's own few lines: it shares no tether geometry with the software under test.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

namespace tautline::sim {

struct Polar {
  double elevation{0.0};  ///< [rad], up positive.
  double azimuth{0.0};    ///< [rad], about +y from z towards x.
};

/// Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] inline Eigen::Vector3d unitVector(const Polar& a) noexcept {
  return {std::cos(a.elevation) * std::sin(a.azimuth), std::sin(a.elevation),
          std::cos(a.elevation) * std::cos(a.azimuth)};
}

/// Of a vector that is not zero; azimuth in (-pi, pi], 0 where it is not defined. Real-time safe:
/// no allocation, no locks, no exceptions.
[[nodiscard]] inline Polar polarOf(const Eigen::Vector3d& v) noexcept {
  return {std::asin(std::clamp(v.y() / v.norm(), -1.0, 1.0)), std::atan2(v.x(), v.z())};
}

/// Angle brought to (-pi, pi]. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] inline double wrapped(double angle) noexcept {
  const double turns = std::ceil(angle / (2.0 * std::numbers::pi) - 0.5);
  return angle - 2.0 * std::numbers::pi * turns;
}

[[nodiscard]] constexpr double radians(double degrees) noexcept {
  return degrees * std::numbers::pi / 180.0;
}

}  // namespace tautline::sim
