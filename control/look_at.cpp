#include "control/look_at.h"

#include <algorithm>
#include <cmath>

#include "common/tether_geometry.h"

namespace tautline {

std::optional<double> headingOf(const Eigen::Quaterniond& R_WB) noexcept {
  const Eigen::Vector3d forward = R_WB * Eigen::Vector3d::UnitX();
  constexpr double kVertical = 0.0175;  // sin(1 deg)
  if (!forward.allFinite() || std::hypot(forward.x(), forward.z()) < kVertical) return {};
  return std::atan2(forward.x(), forward.z());
}

LookAtRates lookAt(const LookAtConfig& config, const VehicleLimits& limits,
                   const Eigen::Vector3d& p_WD, const Eigen::Vector3d& p_WL,
                   const std::optional<Eigen::Quaterniond>& R_WB,
                   const std::optional<double>& gimbal_pitch) noexcept {
  LookAtRates out;
  const Eigen::Vector3d p_DL = p_WL - p_WD;
  const double distance = std::hypot(p_DL.x(), p_DL.z());
  if (!p_DL.allFinite() || p_DL.norm() < config.min_distance_m) return out;
  if (const std::optional<double> heading = R_WB ? headingOf(*R_WB) : std::nullopt;
      heading && distance >= config.min_distance_m) {
    const double error = wrapAngle(std::atan2(p_DL.x(), p_DL.z()) - *heading);
    out.yaw_rate =
        std::clamp(config.yaw_gain_per_s * error, -limits.yaw_rate_radps, limits.yaw_rate_radps);
  }
  if (gimbal_pitch && std::isfinite(*gimbal_pitch)) {
    const double error = wrapAngle(std::atan2(p_DL.y(), distance) - *gimbal_pitch);
    out.gimbal_pitch_rate =
        std::clamp(config.gimbal_gain_per_s * error, -limits.gimbal_pitch_rate_radps,
                   limits.gimbal_pitch_rate_radps);
  }
  return out;
}

}  // namespace tautline
