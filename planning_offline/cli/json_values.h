#pragma once

/// @file
/// Values that all verbs print alike. Not real-time safe: offline only.

#include <cmath>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

namespace tautline::planning {

/// [x, y, z]
[[nodiscard]] inline nlohmann::json toJson(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

/// JSON has no infinity.
[[nodiscard]] inline nlohmann::json numberOrNull(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

}  // namespace tautline::planning
