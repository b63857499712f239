#include "sim_hil/vehicle.h"

#include <algorithm>
#include <cmath>

namespace tautline::sim {
namespace {

constexpr double kGravity = 9.81;
constexpr double kGimbalLimit = radians(90.0);
constexpr double kTautTension = 0.1;  // below this the tether's direction says less and less [N]

}  // namespace

Vehicle::Vehicle(const VehicleConfig& config) noexcept : config_(config) {}

void Vehicle::startTakeoff() noexcept {
  if (phase_ != FlightPhase::kParked) return;
  phase_ = FlightPhase::kSpoolUp;
  phase_time_ = 0.0;
}

void Vehicle::stopMotors() noexcept {
  phase_ = FlightPhase::kParked;
  phase_time_ = 0.0;
  thrust_ = 0.0;
}

void Vehicle::emergencyLand() noexcept {
  if (phase_ == FlightPhase::kTakeoff || phase_ == FlightPhase::kFlying) {
    phase_ = FlightPhase::kEmergencyLand;
    phase_time_ = 0.0;
  }
}

void Vehicle::step(double h, const VehicleSense& sense) noexcept {
  phase_time_ += h;
  advancePhase(h, sense);
  if (!motorsOn()) {
    thrust_ = 0.0;
    if (sense.on_ground) up_ = Eigen::Vector3d::UnitY();
    return;
  }
  flight_time_ += h;
  if (phase_ == FlightPhase::kFlying) {
    yaw_ = wrapped(yaw_ + h * rates_.yaw);
    gimbal_pitch_ =
        std::clamp(gimbal_pitch_ + h * rates_.gimbal_pitch, -kGimbalLimit, kGimbalLimit);
    gimbal_roll_ = std::clamp(gimbal_roll_ + h * rates_.gimbal_roll, -kGimbalLimit, kGimbalLimit);
  }
  filterDirection(h, sense);
  integrateSetpoint(h, sense);
  if (phase_ == FlightPhase::kSpoolUp) {
    followForce(h, {0.0, 0.5 * config_.mass * kGravity, 0.0});
  } else {
    followForce(h, wantedForce(sense));
  }
}

void Vehicle::advancePhase(double h, const VehicleSense& sense) noexcept {
  const auto enter = [&](FlightPhase phase) {
    phase_ = phase;
    phase_time_ = 0.0;
  };
  switch (phase_) {
    case FlightPhase::kParked:
    case FlightPhase::kFlying:
      break;
    case FlightPhase::kSpoolUp:
      setpoint_ = sense.tangent;
      if (phase_time_ >= config_.spool_up) enter(FlightPhase::kTakeoff);
      break;
    case FlightPhase::kTakeoff:
      if (setpoint_.elevation >= config_.takeoff_elevation - config_.takeoff_rate * h) {
        enter(FlightPhase::kFlying);
      }
      break;
    case FlightPhase::kEmergencyLand:
      if (sense.on_ground && sense.v_WD.norm() < 0.1 && phase_time_ > 0.5) stopMotors();
      break;
  }
}

void Vehicle::integrateSetpoint(double h, const VehicleSense& sense) noexcept {
  Polar rate;
  switch (phase_) {
    case FlightPhase::kTakeoff:
      rate.elevation = config_.takeoff_rate;
      break;
    case FlightPhase::kFlying:
      rate = {rates_.elevation, rates_.azimuth};
      break;
    case FlightPhase::kEmergencyLand:
      // Down along the sphere of the tether, slowly enough for the ground.
      rate.elevation = -config_.landing_rate / std::fmax(sense.length, config_.lever_min);
      break;
    default:
      break;
  }
  const double before = setpoint_.elevation;
  setpoint_.elevation = std::clamp(setpoint_.elevation + h * rate.elevation, config_.elevation_min,
                                   config_.elevation_max);
  setpoint_.azimuth = wrapped(setpoint_.azimuth + h * rate.azimuth);
  setpoint_rate_ = {(setpoint_.elevation - before) / h, rate.azimuth};
}

double Vehicle::lever(const VehicleSense& sense) const noexcept {
  return std::clamp(sense.length, config_.lever_min, config_.lever_max);
}

/// Complementary filter: the vehicle's own motion turns the tether at once, the sensed direction
/// corrects slowly, so that waves on the tether do not shake the vehicle.
void Vehicle::filterDirection(double h, const VehicleSense& sense) noexcept {
  const Eigen::Vector3d sensed = unitVector(
      {sense.tangent.elevation - sense.bias.elevation, sense.tangent.azimuth - sense.bias.azimuth});
  if (phase_ == FlightPhase::kSpoolUp) {
    direction_ = sensed;
    return;
  }
  const double taut = std::clamp(sense.tension / kTautTension, 0.0, 1.0);
  const Eigen::Vector3d across = sense.v_WD - direction_ * direction_.dot(sense.v_WD);
  direction_ += h * (across / std::fmax(sense.length, config_.lever_min) +
                     taut / config_.angle_filter * (sensed - direction_));
  direction_.normalize();
}

/// Weight + pull along the set-point direction + PD on the angle error. The angle error acts
/// through the tether as a lever; damping is on the velocity relative to that of the set-point.
Eigen::Vector3d Vehicle::wantedForce(const VehicleSense& sense) const noexcept {
  const Polar target{setpoint_.elevation - sense.bias.elevation,
                     setpoint_.azimuth - sense.bias.azimuth};
  const Eigen::Vector3d d_target = unitVector(target);
  Eigen::Vector3d error = d_target - direction_;
  error -= direction_ * direction_.dot(error);

  const double taut = std::clamp(sense.tension / kTautTension, 0.0, 1.0);
  const double w = config_.bandwidth;
  Eigen::Vector3d correction = taut * config_.mass * w * w * lever(sense) * error;
  const double size = correction.norm();
  if (size > config_.correction_max) correction *= config_.correction_max / size;

  const double ce = std::cos(target.elevation);
  const double se = std::sin(target.elevation);
  const double ca = std::cos(target.azimuth);
  const double sa = std::sin(target.azimuth);
  const Eigen::Vector3d along_elevation(-se * sa, ce, -se * ca);
  const Eigen::Vector3d along_azimuth(ca, 0.0, -sa);
  const Eigen::Vector3d v_target =
      sense.length_rate * d_target + lever(sense) * (setpoint_rate_.elevation * along_elevation +
                                                     setpoint_rate_.azimuth * ce * along_azimuth);
  return Eigen::Vector3d(0.0, config_.mass * kGravity, 0.0) +
         disturbance_.tension.value_or(config_.tension) * d_target + correction +
         2.0 * config_.damping * w * config_.mass * (v_target - sense.v_WD);
}

/// Tilt and thrust limits, then first-order lags of direction and magnitude.
void Vehicle::followForce(double h, const Eigen::Vector3d& force) noexcept {
  Eigen::Vector3d wanted = force;
  wanted.y() = std::fmax(wanted.y(), 0.3 * config_.mass * kGravity);
  const double sideways = std::hypot(wanted.x(), wanted.z());
  const double allowed = wanted.y() * std::tan(config_.tilt_max);
  if (sideways > allowed) {
    wanted.x() *= allowed / sideways;
    wanted.z() *= allowed / sideways;
  }
  const double limit =
      std::fmax(config_.thrust_min, disturbance_.thrust_limit * config_.thrust_max);
  const double magnitude = std::clamp(wanted.norm(), config_.thrust_min, limit);
  const Eigen::Vector3d direction = wanted.normalized();
  up_ = (up_ + (1.0 - std::exp(-h / config_.attitude_lag)) * (direction - up_)).normalized();
  thrust_ += (1.0 - std::exp(-h / config_.motor_lag)) * (magnitude - thrust_);
}

Eigen::Quaterniond Vehicle::attitude() const noexcept {
  const Eigen::Quaterniond heading(Eigen::AngleAxisd(yaw_, Eigen::Vector3d::UnitY()));
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), up_) * heading;
}

double Vehicle::batteryVoltage() const noexcept {
  const double used = std::fmin(1.0, flight_time_ / config_.battery_life);
  const double load = motorsOn() ? 0.2 : 0.0;  // drop under load [V]
  return config_.battery - used * (config_.battery - config_.battery_empty) - load;
}

}  // namespace tautline::sim
