#include "control/command_gate.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace tautline {
namespace {

Eigen::Vector3d tetherRates(const VehicleCommand& c) noexcept {
  return {c.length_rate, c.elevation_rate, c.azimuth_rate};
}

void setTetherRates(VehicleCommand& c, const Eigen::Vector3d& u) noexcept {
  c.length_rate = u.x();
  c.elevation_rate = u.y();
  c.azimuth_rate = u.z();
}

/// Factor in (0, 1] that brings each |u_i| under limit_i; 1 where that is so already, or where u is
/// NaN.
double scaleInto(const Eigen::Vector3d& u, const Eigen::Vector3d& limit) noexcept {
  double excess = 1.0;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(u[i]) > limit[i] * excess) excess = std::abs(u[i]) / limit[i];
  }
  return 1.0 / excess;
}

bool isFinite(const VehicleCommand& c) noexcept {
  return tetherRates(c).allFinite() && std::isfinite(c.yaw_rate) &&
         std::isfinite(c.gimbal_pitch_rate);
}

void stop(VehicleCommand& c) noexcept {
  setTetherRates(c, Eigen::Vector3d::Zero());
  c.yaw_rate = 0.0;
  c.gimbal_pitch_rate = 0.0;
}

}  // namespace

GatedCommand CommandGate::apply(Duration dt, const VehicleCommand& in) noexcept {
  GatedCommand out{.command = in};
  VehicleCommand& c = out.command;
  if (!in.engaged) stop(c);

  // Clamp.
  const Eigen::Vector3d rate_limit(limits_.length_rate_mps, limits_.elevation_rate_radps,
                                   limits_.azimuth_rate_radps);
  const double scale = scaleInto(tetherRates(c), rate_limit);
  const auto clampOne = [&](double& rate, double limit) {
    out.clamped = out.clamped || std::abs(rate) > limit;
    rate = std::clamp(rate, -limit, limit);
  };
  out.clamped = scale < 1.0;
  setTetherRates(c, scale * tetherRates(c));
  clampOne(c.yaw_rate, limits_.yaw_rate_radps);
  clampOne(c.gimbal_pitch_rate, limits_.gimbal_pitch_rate_radps);

  // Rate limit. Rest without engagement needs no slope: the device gets zeros then in any case.
  if (in.engaged) {
    constexpr double kLongestStep = 0.1;  // [s]
    const double seconds = std::clamp(toSeconds(dt), 0.0, kLongestStep);
    const Eigen::Vector3d most =
        seconds * Eigen::Vector3d(config_.length_accel_mps2, config_.elevation_accel_radps2,
                                  config_.azimuth_accel_radps2);
    const Eigen::Vector3d change = tetherRates(c) - tetherRates(last_);
    const double share = seconds > 0.0 ? scaleInto(change, most) : (change.isZero(0.0) ? 1.0 : 0.0);
    out.slewed = share < 1.0;
    if (out.slewed) setTetherRates(c, tetherRates(last_) + share * change);
    const auto slewOne = [&](double& rate, double last, double accel) {
      const double bounded = std::clamp(rate, last - accel * seconds, last + accel * seconds);
      out.slewed = out.slewed || std::abs(rate - bounded) > 0.0;
      rate = bounded;
    };
    slewOne(c.yaw_rate, last_.yaw_rate, config_.yaw_accel_radps2);
    slewOne(c.gimbal_pitch_rate, last_.gimbal_pitch_rate, config_.gimbal_accel_radps2);
  }

  // Finite check, last: nothing that went wrong above may pass.
  out.not_finite = !isFinite(in) || !isFinite(c);
  if (out.not_finite) stop(c);
  last_ = c;
  return out;
}

}  // namespace tautline
