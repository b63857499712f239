#include "control/descent.h"

#include <algorithm>

#include "common/tether_geometry.h"

namespace tautline {
namespace {

constexpr double kBelowGround = 0.3;       // [m] error of the last place and of the reckoning
constexpr double kGroundAltitude = 0.3;    // [m] no higher, by barometer: on the ground
constexpr double kSmoothing = 1.0;         // [s] of the barometer, whose noise is decimetres
constexpr double kSmallestDescent = 0.02;  // [m]
constexpr Duration kNoLowerFor = std::chrono::seconds(3);

}  // namespace

void Descent::begin(const Eigen::Vector3d& p_AD, double height) noexcept {
  p_AD_ = p_AD;
  ground_ = p_AD.y() - height;
  altitude_.reset();
  no_lower_for_ = Duration(0);
}

RateCommand Descent::update(Duration dt, double speed, const VehicleLimits& limits,
                            std::optional<double> altitude) noexcept {
  const double step = std::max(0.0, toSeconds(dt));
  no_lower_for_ += std::max(dt, Duration(0));
  if (!altitude) {
    altitude_.reset();
  } else if (!altitude_) {
    altitude_ = lowest_ = *altitude;
    no_lower_for_ = Duration(0);
  } else {
    *altitude_ += std::min(1.0, step / kSmoothing) * (*altitude - *altitude_);
  }
  if (altitude_ && *altitude_ < lowest_ - kSmallestDescent) {
    lowest_ = *altitude_;
    no_lower_for_ = Duration(0);
  }

  const TetherCoordinates q = toTether(p_AD_);
  RateCommand rates =
      scaleTogether(ratesFromVelocity(q, Eigen::Vector3d(0.0, -speed, 0.0)), limits);
  if (reckonedDown()) {
    rates.length_rate = 0.0;
  } else {
    p_AD_ += step * velocityFromRates(q, {rates.length_rate, rates.elevation_rate, 0.0});
  }
  return rates;
}

bool Descent::reckonedDown() const noexcept { return p_AD_.y() < ground_ - kBelowGround; }

bool Descent::onGround() const noexcept {
  return reckonedDown() &&
         (!altitude_ || *altitude_ < kGroundAltitude || no_lower_for_ > kNoLowerFor);
}

}  // namespace tautline
