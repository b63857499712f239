#include "control/test/kinematic_plant.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace tautline::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Eigen::Vector3d cartesian(const Eigen::Vector3d& q) {
  return q[0] * Eigen::Vector3d(std::cos(q[1]) * std::sin(q[2]), std::sin(q[1]),
                                std::cos(q[1]) * std::cos(q[2]));
}

Eigen::Vector3d polar(const Eigen::Vector3d& p) {
  return {p.norm(), std::atan2(p.y(), std::hypot(p.x(), p.z())), std::atan2(p.x(), p.z())};
}

}  // namespace

KinematicPlant::KinematicPlant(const PlantConfig& config, const Eigen::Vector3d& p_WD,
                               unsigned seed)
    : config_(config), p_AD_(p_WD - config.p_WA), q_(polar(p_WD - config.p_WA)), random_(seed) {
  queue_.fill(Eigen::Vector3d::Zero());
}

void KinematicPlant::step(const RateCommand& command) {
  const VehicleLimits& limits = config_.limits;
  const auto clamp = [](double x, double limit) { return std::clamp(x, -limit, limit); };
  queue_[head_] = {clamp(command.length_rate, limits.length_rate_mps),
                   clamp(command.elevation_rate, limits.elevation_rate_radps),
                   clamp(command.azimuth_rate, limits.azimuth_rate_radps)};
  const std::size_t size = queue_.size();
  const Eigen::Vector3d u =
      queue_[(head_ + size - static_cast<std::size_t>(config_.latency_steps)) % size];
  head_ = (head_ + 1) % size;

  constexpr int kSubSteps = 5;
  for (int i = 0; i < kSubSteps; ++i) {
    if (config_.kind == PlantConfig::Kind::kRate) {
      moveByRates(u, kPlantStep / kSubSteps);
    } else {
      moveSetPoints(u, kPlantStep / kSubSteps);
    }
  }
}

void KinematicPlant::moveByRates(const Eigen::Vector3d& u, double dt) {
  u_ += (u - u_) * (dt / config_.lag);
  if (config_.stops_at_pole) q_ = polar(p_AD_);
  q_ += u_ * dt;
  p_AD_ = cartesian(q_);
}

void KinematicPlant::moveSetPoints(const Eigen::Vector3d& u, double dt) {
  q_ += u * dt;
  q_[0] = std::max(q_[0], 0.0);
  if (config_.stops_at_pole) q_[1] = std::clamp(q_[1], -89.5 * kDegree, 89.5 * kDegree);
  p_AD_ += (cartesian(q_) - p_AD_) * (dt / config_.lag);
}

Estimate KinematicPlant::measure() {
  std::normal_distribution<double> error(0.0, config_.noise * kDegree);
  const Eigen::Vector3d e = p_AD_.normalized();
  const Eigen::Vector3d other =
      std::abs(e.y()) < 0.9 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d a = e.cross(other).normalized();
  const double error_a = error(random_);
  const double error_b = error(random_);
  Estimate out;
  out.valid = true;
  out.health = EstimateHealth::kOk;
  out.p_WD = config_.p_WA + p_AD_.norm() * (e + error_a * a + error_b * e.cross(a)).normalized();
  const double sigma = std::max(0.005, config_.noise * kDegree * p_AD_.norm());
  out.P_position = sigma * sigma * Eigen::Matrix3d::Identity();
  return out;
}

}  // namespace tautline::testing
