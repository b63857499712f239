#pragma once

/// @file
/// Simulated flights for the localizer's tests, generated independently of it: the drone moves in
/// arc length, tangent elevation and azimuth, where the sensors read directly, and its true
/// position is the numerically integrated force balance of the tether
/// (common/testing/catenary_oracle.h). No formula is shared with the code under test.

#include <cstdint>
#include <deque>
#include <random>

#include <Eigen/Core>

#include "common/estimate.h"
#include "common/time.h"
#include "common/vehicle.h"

namespace tautline::testing {

struct FlightOptions {
  std::uint32_t seed{1};
  double ground_time{1.0};  ///< Idle on the ground before the flight [s].
  double rate{10.0};        ///< Of every sensor [Hz].
  double latency{0.0};      ///< From measurement to arrival [s].

  double length_quantum{0.0};  ///< [m]
  double angle_quantum{0.0};   ///< [rad]
  double length_sigma{0.0};    ///< White noise, as all that follow.
  double angle_sigma{0.0};
  bool has_altitude{true};
  double altitude_sigma{0.0};
  bool has_attitude{true};
  double lean_sigma{0.0};
  bool has_reel_tension{false};
  double reel_tension_sigma{0.0};  ///< Relative.

  double reel_scale{1.0};  ///< True metres per nominal metre.
  double elevation_bias{0.0};
  double azimuth_zero{0.0};
  double altitude_offset{0.0};

  double T_nominal{0.8};               ///< [N]
  double tension_sigma{0.0};           ///< Of ln T, first-order with tension_time_constant.
  double tension_time_constant{10.0};  ///< [s]
  double velocity_sigma{0.0};          ///< Departure from the commanded velocity, first-order ...
  double velocity_time_constant{0.4};  ///< ... with this lag [s].
  bool moving{true};                   ///< False: hovers at one point.
  double steepest{1.2};                ///< Highest tangent elevation of the flight [rad].

  double w{0.0061 * 9.81};
  double G{6.0};
};

class FlightGenerator {
 public:
  explicit FlightGenerator(const FlightOptions& options);

  static constexpr double kCycle = 0.02;  ///< [s]

  /// One cycle further. The frame is then that of the new now(), the command the one that acted
  /// since the old one.
  void step();

  [[nodiscard]] Time now() const { return now_; }
  [[nodiscard]] const SensorFrame& frame() const { return frame_; }
  [[nodiscard]] SensorFrame& frame() { return frame_; }
  [[nodiscard]] const VehicleCommand& lastCommand() const { return command_; }
  [[nodiscard]] const Anchor& anchor() const { return anchor_; }

  /// Truth, by numerical integration: call it when it is needed, not every cycle.
  [[nodiscard]] Eigen::Vector3d truePosition() const;
  [[nodiscard]] double trueTension() const { return T_; }

  /// No new samples arrive while true.
  bool silent{false};
  /// Puts the drone on the ground or back into the air.
  VehiclePhase phase_in_flight{VehiclePhase::kFlying};
  /// Moves the anchor; the drone stays where it is relative to it, so it moves with it.
  void setAnchor(const Anchor& anchor) { anchor_ = anchor; }

 private:
  struct Polar {
    double L, theta, phi;
  };
  [[nodiscard]] Polar reference(double t) const;
  void sense();
  [[nodiscard]] double normal() { return normal_(random_); }

  FlightOptions options_;
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  Time now_{};
  Time next_sample_{};
  double t_{0.0};  // [s] since take-off; negative on the ground
  Polar q_{};
  Eigen::Vector3d departure_{
      Eigen::Vector3d::Zero()};  // velocity beyond the commanded one, along L, theta, phi
  Eigen::Vector3d v_lagged_{Eigen::Vector3d::Zero()};  // commanded velocity, lagged
  double T_;
  Anchor anchor_;
  double start_height_;  // height readings count from here
  SensorFrame frame_;
  SensorFrame sensed_;
  struct Transit {
    Time arrival;
    SensorFrame frame;
  };
  std::deque<Transit> in_transit_;
  VehicleCommand command_;
};

}  // namespace tautline::testing
