#pragma once

/// @file
/// A flight behind a carried marker: bench, camera, and the servo as the operator's program, which
/// moves the sticks. Not real-time safe.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "app/bench/lockstep.h"
#include "control/visual_servo.h"
#include "sim_hil/camera.h"

namespace tautline::experiments {

/// How a marker is carried: round the reel and back, up and down, nearer and farther, turned a
/// little; smooth, from a few seeded sines. Its mean speed is what somebody who carries it would
/// walk so that a drone with the reference device's azimuth limit can follow.
class CarriedMarker {
 public:
  explicit CarriedMarker(std::uint64_t seed);
  /// Pose in W `t` [s] after the beginning.
  [[nodiscard]] sim::Pose at(double t) const;

 private:
  struct Sine {
    double amplitude{0.0};
    double omega{0.0};  ///< [rad/s]
    double phase{0.0};
  };
  /// About zero, with the standard deviation `spread`.
  struct Wobble {
    std::vector<Sine> sines;
    [[nodiscard]] double at(double t) const;
  };

  double turn_phase_;
  Wobble azimuth_, radius_, height_, yaw_, pitch_;
};

/// The marker as the camera sees it, minus where it should be: dissertation's axes, x to the right,
/// y down, z along the optical axis.
struct ServoError {
  double t{0.0};                                         ///< Since the beginning [s].
  Eigen::Vector3d translation{Eigen::Vector3d::Zero()};  ///< [m]
  double yaw{0.0};                                       ///< [rad]
  double pitch{0.0};                                     ///< [rad]
  double roll{0.0};                                      ///< [rad]
  Eigen::Vector3d p_WD{Eigen::Vector3d::Zero()};         ///< Drone [m].
  Eigen::Vector3d p_WM{Eigen::Vector3d::Zero()};         ///< Marker [m].
};

struct ServoFlight {
  bool servoed{false};   ///< The drone got as far as being servoed, and to the end of it.
  double in_sight{0.0};  ///< Share of pictures with the marker in them.
  sim::CrashReason crash{sim::CrashReason::kNone};
  std::vector<ServoError> errors;  ///< 10 a second, from `settle` on.
};

struct ServoFlightConfig {
  bench::LockstepConfig bench;
  VisualServoConfig servo;
  sim::CameraConfig camera;
  double settle{15.0};  ///< Before errors count [s].
  double duration{120.0};
};

[[nodiscard]] ServoFlight flyServo(const ServoFlightConfig& config);

}  // namespace tautline::experiments
