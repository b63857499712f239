#pragma once

/// @file
/// The last gate between any control law (or stick) and the supervisor's override: clamp, then rate
/// limit, then finite check, always in this order (docs/control.md).

#include "common/fields.h"
#include "common/time.h"
#include "common/vehicle.h"
#include "control/vehicle_limits.h"

namespace tautline {

/// Largest change of each rate per second.
struct CommandGateConfig {
  double length_accel_mps2{1.5};
  double elevation_accel_radps2{1.0};
  double azimuth_accel_radps2{1.0};
  double yaw_accel_radps2{2.0};
  double gimbal_accel_radps2{2.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_accel_mps2", length_accel_mps2, Range{0.01, 1000.0}, "change of length rate");
    v.field("elevation_accel_radps2", elevation_accel_radps2, Range{0.01, 1000.0},
            "change of elevation rate");
    v.field("azimuth_accel_radps2", azimuth_accel_radps2, Range{0.01, 1000.0},
            "change of azimuth rate");
    v.field("yaw_accel_radps2", yaw_accel_radps2, Range{0.01, 1000.0}, "change of yaw rate");
    v.field("gimbal_accel_radps2", gimbal_accel_radps2, Range{0.01, 1000.0},
            "change of gimbal pitch rate");
  }
};

struct GatedCommand {
  VehicleCommand command;  ///< Finite and within the limits, whatever came in.
  bool clamped{false};     ///< A rate was beyond its limit.
  bool slewed{false};      ///< A rate may not change that fast.
  bool not_finite{false};  ///< Something was NaN or infinite: all rates are zero, at once.
};

/// The three tether rates are scaled by one common factor, and so are their changes: the motion
/// keeps its direction in tether space. Yaw and gimbal are bounded each by itself.
class CommandGate {
 public:
  CommandGate(const CommandGateConfig& config, const VehicleLimits& limits) noexcept
      : config_(config), limits_(limits) {}

  /// Starts from rest. A command that is not engaged is rest, without slope. dt <= 0 lets nothing
  /// change; more than 0.1 s counts as 0.1 s, so that a late cycle is no licence to jump. Real-time
  /// safe: no allocation, no locks, no exceptions.
  [[nodiscard]] GatedCommand apply(Duration dt, const VehicleCommand& in) noexcept;

  /// Real-time safe: no allocation, no locks, no exceptions.
  void reset() noexcept { last_ = VehicleCommand{}; }

 private:
  CommandGateConfig config_;
  VehicleLimits limits_;
  VehicleCommand last_;
};

}  // namespace tautline
