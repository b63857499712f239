#include "estimation/lean_tension.h"

#include <algorithm>
#include <cmath>

#include "estimation/tension.h"

namespace tautline {

void LeanTension::update(const Sample<AttitudeReading>& attitude, double theta,
                         double phi) noexcept {
  theta_ = theta;
  if (!attitude.valid || attitude.sequence == sequence_) return;
  const double beta = thrustElevationInPlane(attitude.value.R_WB, phi);
  const double dt = std::max(0.0, toSeconds(attitude.time - time_));
  const double gain = sequence_ == 0 ? 1.0 : 1.0 - std::exp(-dt / time_constant_);
  beta_ += gain * (beta - beta_);
  sequence_ = attitude.sequence;
  time_ = attitude.time;
}

std::optional<double> LeanTension::tension() const noexcept {
  if (sequence_ == 0 || std::sin(angle()) < std::sin(least_angle_)) return std::nullopt;
  const LeanForces forces = forcesFromLean(beta_, theta_, G_);
  return forces.ok ? forces.T : 0.0;
}

double LeanTension::tensionError(double tension, double error) const noexcept {
  return error / std::abs(leanModel(tension, theta_, G_).dbeta_dT);
}

}  // namespace tautline
