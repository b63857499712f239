#pragma once

/// @file
/// The flying vehicle: a point mass with a lagging thrust vector, and the onboard loop that holds
/// the tether's tangent at a set-point direction by pulling on the taut tether. It has no position
/// of its own: it feels the tether's direction and tension, and its velocity. World frame W.

#include <cstdint>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/fields.h"
#include "sim_hil/polar.h"

namespace tautline::sim {

struct VehicleConfig {
  double mass{0.618};             ///< [kg], 6 N.
  double thrust_max{12.0};        ///< [N]
  double thrust_min{0.6};         ///< With motors running [N].
  double attitude_lag{0.15};      ///< Of the thrust direction [s].
  double motor_lag{0.05};         ///< Of the thrust magnitude [s].
  double tilt_max{radians(35)};   ///< [rad]
  double drag{0.2};               ///< Body and rotors, linear [N/(m/s)].
  double radius{0.15};            ///< What must not touch anything [m].
  double survivable_impact{1.5};  ///< On the ground [m/s].
  double tension{1.0};            ///< Pull on the tether that the onboard loop adds [N].
  double bandwidth{2.2};          ///< Of the onboard angle loop [rad/s].
  double damping{1.0};            ///< Its damping ratio without lags.
  double correction_max{2.0};     ///< Largest force of the angle error [N].
  double angle_filter{0.8};  ///< Of the sensed tether direction against the vehicle's motion [s].
  double lever_min{0.3};     ///< Angle errors count as on a tether of at least ... [m]
  double lever_max{8.0};     ///< ... and at most this length [m].
  double elevation_min{radians(-60)};  ///< Set-point limits [rad].
  double elevation_max{radians(89.5)};
  double takeoff_elevation{radians(50)};  ///< The set-point rises to at least this [rad].
  double takeoff_rate{0.3};               ///< That rise [rad/s].
  double spool_up{1.0};                   ///< From motor start to lift [s].
  double landing_rate{0.12};              ///< Descent of an emergency landing [m/s].
  double battery{12.4};                   ///< Ground battery when full [V].
  double battery_life{1500.0};            ///< Time in flight until `battery_empty` [s].
  double battery_empty{10.5};             ///< [V]
  double battery_low{11.1};               ///< Flag LOW_BATT below [V].
  double battery_critical{10.7};          ///< Flag CRIT_LOW_BATT below [V].
  double backup_battery{4.15};            ///< On the vehicle [V].

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("mass_kg", mass, Range{0.05, 20}, "without tether");
    v.field("thrust_max_n", thrust_max, Range{1, 500}, "all motors");
    v.field("thrust_min_n", thrust_min, Range{0, 10}, "motors running");
    v.field("attitude_lag_s", attitude_lag, Range{0.01, 1}, "of the thrust direction");
    v.field("motor_lag_s", motor_lag, Range{0.005, 1}, "of the thrust magnitude");
    v.field("tilt_max_rad", tilt_max, Range{0.05, 1.2}, "largest lean");
    v.field("drag_n_per_mps", drag, Range{0, 10}, "body and rotors, linear");
    v.field("radius_m", radius, Range{0.02, 2}, "what must not touch anything");
    v.field("survivable_impact_mps", survivable_impact, Range{0.1, 10}, "on the ground");
    v.field("tension_n", tension, Range{0, 10}, "pull on the tether that the onboard loop adds");
    v.field("bandwidth_rad_per_s", bandwidth, Range{0.2, 10}, "of the onboard angle loop");
    v.field("damping", damping, Range{0.1, 3}, "its damping ratio without lags");
    v.field("correction_max_n", correction_max, Range{0.1, 50}, "largest force of the angle error");
    v.field("angle_filter_s", angle_filter, Range{0.01, 5},
            "time constant of the sensed tether direction against the vehicle's own motion");
    v.field("lever_min_m", lever_min, Range{0.05, 5}, "least length for the angle loop's gain");
    v.field("lever_max_m", lever_max, Range{0.5, 50}, "largest length for the angle loop's gain");
    v.field("elevation_min_rad", elevation_min, Range{-1.5, 0}, "set-point limit");
    v.field("elevation_max_rad", elevation_max, Range{0.5, 1.5707}, "set-point limit");
    v.field("takeoff_elevation_rad", takeoff_elevation, Range{0.1, 1.5},
            "the set-point rises to at least this");
    v.field("takeoff_rate_rad_per_s", takeoff_rate, Range{0.02, 2}, "that rise");
    v.field("spool_up_s", spool_up, Range{0.1, 10}, "from motor start to lift");
    v.field("landing_rate_mps", landing_rate, Range{0.02, 1}, "descent of an emergency landing");
    v.field("battery_v", battery, Range{1, 60}, "ground battery when full");
    v.field("battery_life_s", battery_life, Range{10, 1e6}, "time in flight until empty");
    v.field("battery_empty_v", battery_empty, Range{1, 60}, "ground battery when empty");
    v.field("battery_low_v", battery_low, Range{1, 60}, "flag LOW_BATT below");
    v.field("battery_critical_v", battery_critical, Range{1, 60}, "flag CRIT_LOW_BATT below");
    v.field("backup_battery_v", backup_battery, Range{1, 10}, "on the vehicle");
  }
};

/// Rates of the vehicle's own set-points.
struct VehicleRates {
  double elevation{0.0};     ///< [rad/s]
  double azimuth{0.0};       ///< [rad/s], about +y.
  double yaw{0.0};           ///< [rad/s], about +y.
  double gimbal_pitch{0.0};  ///< [rad/s], up positive.
  double gimbal_roll{0.0};   ///< [rad/s]
};

/// What the onboard loop feels in one step.
struct VehicleSense {
  Polar tangent;                                  ///< Of the tether, with the sensor's bias [rad].
  Polar bias;                                     ///< The part of it that is wrong.
  double tension{0.0};                            ///< [N]
  Eigen::Vector3d v_WD{Eigen::Vector3d::Zero()};  ///< [m/s]
  double length{1.0};                             ///< Tether out [m].
  double length_rate{0.0};                        ///< [m/s]
  bool on_ground{true};
};

/// What keeps the vehicle from flying as it should.
struct VehicleDisturbance {
  double thrust_limit{1.0};       ///< Share of the largest thrust that is left.
  std::optional<double> tension;  ///< The onboard loop pulls with this instead of its own [N].
};

enum class FlightPhase : std::uint8_t {
  kParked,         ///< Motors off.
  kSpoolUp,        ///< Motors start, still standing.
  kTakeoff,        ///< The elevation set-point rises by itself; rate commands wait.
  kFlying,         ///< Follows rate commands.
  kEmergencyLand,  ///< Comes down by itself and stops its motors on the ground.
};

class Vehicle {
 public:
  /// Parked, heading 0: body axes along the world axes. Real-time safe: no allocation, no locks, no
  /// exceptions.
  explicit Vehicle(const VehicleConfig& config) noexcept;

  /// Starts the motors if parked. The set-point becomes the tether's present direction.
  void startTakeoff() noexcept;
  void stopMotors() noexcept;
  /// From any flying phase.
  void emergencyLand() noexcept;
  /// Rates in force until the next call.
  void command(const VehicleRates& rates) noexcept { rates_ = rates; }
  void disturb(const VehicleDisturbance& disturbance) noexcept { disturbance_ = disturbance; }

  /// Advances by h [s]. Real-time safe: no allocation, no locks, no exceptions.
  void step(double h, const VehicleSense& sense) noexcept;

  /// Thrust in W [N]; zero with motors off.
  [[nodiscard]] Eigen::Vector3d thrust() const noexcept { return thrust_ * up_; }
  [[nodiscard]] FlightPhase phase() const noexcept { return phase_; }
  [[nodiscard]] bool motorsOn() const noexcept { return phase_ != FlightPhase::kParked; }
  [[nodiscard]] const Polar& setpoint() const noexcept { return setpoint_; }
  [[nodiscard]] double yaw() const noexcept { return yaw_; }
  /// Body to world, both with y up; level with heading 0 is the identity.
  [[nodiscard]] Eigen::Quaterniond attitude() const noexcept;
  [[nodiscard]] double gimbalPitch() const noexcept { return gimbal_pitch_; }
  [[nodiscard]] double gimbalRoll() const noexcept { return gimbal_roll_; }
  [[nodiscard]] double batteryVoltage() const noexcept;
  [[nodiscard]] double backupVoltage() const noexcept { return config_.backup_battery; }
  [[nodiscard]] const VehicleConfig& config() const noexcept { return config_; }

 private:
  void advancePhase(double h, const VehicleSense& sense) noexcept;
  void integrateSetpoint(double h, const VehicleSense& sense) noexcept;
  void filterDirection(double h, const VehicleSense& sense) noexcept;
  [[nodiscard]] double lever(const VehicleSense& sense) const noexcept;
  [[nodiscard]] Eigen::Vector3d wantedForce(const VehicleSense& sense) const noexcept;
  void followForce(double h, const Eigen::Vector3d& force) noexcept;

  VehicleConfig config_;
  FlightPhase phase_{FlightPhase::kParked};
  double phase_time_{0.0};
  VehicleRates rates_;
  VehicleDisturbance disturbance_;
  Polar setpoint_;
  Polar setpoint_rate_;  // of this step, after limits
  double yaw_{0.0};
  double gimbal_pitch_{0.0};
  double gimbal_roll_{0.0};
  double thrust_{0.0};
  Eigen::Vector3d up_{Eigen::Vector3d::UnitY()};         // thrust direction
  Eigen::Vector3d direction_{Eigen::Vector3d::UnitZ()};  // filtered, of the tether at the vehicle
  double flight_time_{0.0};
};

}  // namespace tautline::sim
