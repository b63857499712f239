#pragma once

/// @file
/// The one interface of all control laws: state and path segment in, tether rates out. Section 6 of
/// docs/tether_model.md, docs/control.md; dissertation section 5.2.
///
/// A law knows nothing of missions, modes or devices: the motion executor gives it the segment to
/// follow, the command gate (control/command_gate.h) bounds what it says, the supervisor may
/// override it.

#include <optional>

#include <Eigen/Core>

#include "common/estimate.h"
#include "common/tether_geometry.h"
#include "common/time.h"
#include "control/vehicle_limits.h"

namespace tautline {

/// What a law sees in one cycle. Positions in world W [m].
struct ControlInput {
  Estimate estimate;
  Anchor anchor;                                  ///< The active anchor A.
  Eigen::Vector3d p_WS{Eigen::Vector3d::Zero()};  ///< Start of the segment to follow.
  Eigen::Vector3d p_WE{Eigen::Vector3d::Zero()};  ///< Its end. S = E means: hold E.
  std::optional<Eigen::Vector3d> p_WN{};          ///< End of the next segment; absent: stop at E.
  double speed{0.3};                              ///< Along the segment [m/s], > 0.
  VehicleLimits limits;
};

/// Rates of the vehicle's set-points, relative to A. All zero unless `ok`.
struct RateCommand {
  bool ok{false};  ///< False: the input cannot be acted on (estimate lost, something not finite).
  double length_rate{0.0};     ///< dL/dt [m/s], pay-out positive.
  double elevation_rate{0.0};  ///< d(theta)/dt [rad/s], up positive.
  double azimuth_rate{0.0};    ///< d(phi)/dt [rad/s].
};

class Controller {
 public:
  virtual ~Controller() = default;

  /// One cycle; `dt` is the measured period, 0 in the first one. Real-time safe: no allocation, no
  /// locks, no exceptions.
  [[nodiscard]] virtual RateCommand update(Duration dt, const ControlInput& in) noexcept = 0;

  /// Forgets everything learned in flight; for a drone on the ground, or a law that takes over in
  /// mid-flight. Changes of target or anchor need no reset. Real-time safe: no allocation, no
  /// locks, no exceptions.
  virtual void reset() noexcept = 0;

  [[nodiscard]] virtual const char* name() const noexcept = 0;
};

/// True if a law may act: estimate valid and not lost, everything finite, speed and limits
/// positive. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] bool isUsable(const ControlInput& in) noexcept;

/// Each rate clamped by itself, as the published laws do: a saturated rate bends the motion.
[[nodiscard]] RateCommand clampEach(const TetherRates& u, const VehicleLimits& limits) noexcept;

/// All three rates scaled by one factor in (0, 1], so that the drone slows down on its line instead
/// of leaving it (C5). Not `ok` if a rate is not finite.
[[nodiscard]] RateCommand scaleTogether(const TetherRates& u, const VehicleLimits& limits) noexcept;

}  // namespace tautline
