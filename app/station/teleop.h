#pragma once

/// @file
/// What the operator's sticks ask for: rates of the vehicle's own set-points, relative to the
/// active anchor, as in VehicleCommand.

namespace tautline {

struct TeleopRates {
  double length{0.0};        ///< dL/dt [m/s], pay-out positive.
  double elevation{0.0};     ///< d(theta)/dt [rad/s], up positive.
  double azimuth{0.0};       ///< d(phi)/dt [rad/s].
  double yaw{0.0};           ///< About +y [rad/s].
  double gimbal_pitch{0.0};  ///< Up positive [rad/s].
};

}  // namespace tautline
