#include "sim_hil/camera.h"

#include <cmath>

namespace tautline::sim {

Eigen::Quaterniond cameraToWorld(double yaw, double pitch) noexcept {
  return Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitZ());
}

bool Camera::sees(const Pose& marker) const noexcept {
  const Eigen::Vector3d& p = marker.position;
  const double distance = p.norm();
  if (distance < 1e-3 || distance > config_.range) return false;
  if (p.x() < distance * std::cos(0.5 * config_.field_of_view)) return false;
  const Eigen::Vector3d face = marker.rotation * Eigen::Vector3d::UnitX();
  return -face.dot(p) > distance * std::cos(config_.view_angle_max);
}

void Camera::step(Time now, const Pose& camera, const Pose& marker, Random& random) noexcept {
  if (!line_.due(now)) return;
  const Eigen::Quaterniond to_camera = camera.rotation.conjugate();
  Pose seen{to_camera * (marker.position - camera.position), to_camera * marker.rotation};
  const Eigen::Vector3d across = config_.bearing_noise * random.normal3();
  const double depth = config_.depth_noise * random.normal();
  const Eigen::Vector3d turn = config_.rotation_noise * random.normal3();
  if (!sees(seen)) {
    line_.sample(now, std::nullopt, random);
    return;
  }
  const double distance = seen.position.norm();
  seen.position =
      seen.position * (1.0 + depth) + distance * Eigen::Vector3d(0.0, across.y(), across.z());
  const double angle = turn.norm();
  if (angle > 0.0)
    seen.rotation = seen.rotation * Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
  line_.sample(now, MarkerDetection{now, seen}, random);
}

}  // namespace tautline::sim
