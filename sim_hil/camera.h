#pragma once

/// @file
/// The vehicle's camera with a tracker of a fiducial marker behind it, such as AprilTag: where the
/// marker is as seen from the camera. Video does not pass the ground station's serial line, so this
/// is no part of the emulated device; whoever flies by the camera holds one beside the plant.
///
/// Camera frame C: x along the optical axis, y up, z to the right. Marker frame M: x out of the
/// marker's face, y up in its picture, z to the right of one who looks along x.

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/fields.h"
#include "common/time.h"
#include "sim_hil/polar.h"
#include "sim_hil/random.h"
#include "sim_hil/sensors.h"

namespace tautline::sim {

struct CameraConfig {
  SensorTiming timing{15.0, 0.15, 0.03};  ///< Video link and detection.
  double field_of_view{radians(60)};      ///< Full angle of the cone that it sees [rad].
  double range{4.0};                      ///< Farther markers are too small [m].
  double view_angle_max{radians(65)};     ///< More oblique ones are too narrow [rad].
  double bearing_noise{0.003};            ///< Of each direction across the axis [rad].
  double depth_noise{0.01};               ///< Relative.
  double rotation_noise{0.02};            ///< About each axis [rad].

  template <class Visitor>
  void fields(Visitor& v) {
    v.section("timing", timing);
    v.field("field_of_view_rad", field_of_view, Range{0.05, 3.1}, "full angle of its cone");
    v.field("range_m", range, Range{0.1, 100}, "farther markers are too small");
    v.field("view_angle_max_rad", view_angle_max, Range{0.05, 1.57},
            "between the marker's face and the line of sight; more oblique ones are too narrow");
    v.field("bearing_noise_rad", bearing_noise, Range{0, 0.5}, "of each direction across the axis");
    v.field("depth_noise", depth_noise, Range{0, 1}, "relative");
    v.field("rotation_noise_rad", rotation_noise, Range{0, 1}, "about each axis");
  }
};

/// Position and orientation of one thing seen from another.
struct Pose {
  Eigen::Vector3d position{Eigen::Vector3d::Zero()};  ///< [m]
  Eigen::Quaterniond rotation{Eigen::Quaterniond::Identity()};
};

/// A marker as it was found in a picture.
struct MarkerDetection {
  Time taken{};  ///< When the picture was.
  Pose marker;   ///< M in C.
};

/// Camera to world for a heading about +y and a pitch above the horizon [rad]; the gimbal keeps the
/// picture upright. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] Eigen::Quaterniond cameraToWorld(double yaw, double pitch) noexcept;

class Camera {
 public:
  explicit Camera(const CameraConfig& config) noexcept
      : config_(config), line_(config.timing, std::nullopt) {}

  /// Takes a picture if one is due. `camera` and `marker` are poses in W. Real-time safe: no
  /// allocation, no locks, no exceptions.
  void step(Time now, const Pose& camera, const Pose& marker, Random& random) noexcept;

  /// What the newest picture that has been worked through showed; none: no marker in it. Real-time
  /// safe: no allocation, no locks, no exceptions.
  [[nodiscard]] std::optional<MarkerDetection> read(Time now) noexcept { return line_.read(now); }

 private:
  [[nodiscard]] bool sees(const Pose& marker) const noexcept;

  CameraConfig config_;
  DelayLine<std::optional<MarkerDetection>> line_;
};

}  // namespace tautline::sim
