#include "supervision/detect/jump_detector.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "common/tether_geometry.h"

namespace tautline {
namespace {

/// Between two directions [rad]; regular at the pole, where the azimuth alone may turn round.
double angleBetween(const SampledAngles& a, const SampledAngles& b) noexcept {
  const Eigen::Vector3d u = toCartesian({1.0, a.theta, a.phi});
  const Eigen::Vector3d v = toCartesian({1.0, b.theta, b.phi});
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

void JumpDetector::update(const SampledLength& length, const SampledAngles& angles,
                          Findings& out) noexcept {
  const auto allowed = [&](Time before, Time now, double rate, double noise) {
    return noise + rate * (std::max(0.0, toSeconds(now - before)) + config_.time_jitter_s);
  };
  if (length.sequence != 0 && (!last_length_ || length.sequence != last_length_->sequence)) {
    if (last_length_) {
      length_step_ = {std::abs(length.length - last_length_->length),
                      allowed(last_length_->time, length.time, config_.length_rate_mps,
                              config_.length_noise_m)};
    }
    last_length_ = length;
  }
  if (angles.sequence != 0 && (!last_angles_ || angles.sequence != last_angles_->sequence)) {
    if (last_angles_) {
      angle_step_ = {angleBetween(*last_angles_, angles),
                     allowed(last_angles_->time, angles.time, config_.angle_rate_radps,
                             config_.angle_noise_rad)};
    }
    last_angles_ = angles;
  }
  out.reportAbove(Condition::kReelJump, length_step_.size, length_step_.allowed);
  out.reportAbove(Condition::kAnglesJump, angle_step_.size, angle_step_.allowed);
}

}  // namespace tautline
