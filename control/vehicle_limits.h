#pragma once

/// @file
/// What the vehicle and the reel can do, as the control laws and the last gate need it.

#include "common/fields.h"

namespace tautline {

/// Largest magnitudes; all positive. Defaults are those of the reference device (docs/devices.md);
/// its reel accepts far more, 0.6 m/s is what it follows without losing the tether.
struct VehicleLimits {
  double length_rate_mps{0.6};
  double elevation_rate_radps{0.25};
  double azimuth_rate_radps{0.2};
  double yaw_rate_radps{0.4};
  double gimbal_pitch_rate_radps{0.3};
  double tether_length_m{10.0};  ///< Total length on the reel.

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_rate_mps", length_rate_mps, Range{0.01, 30.0},
            "largest pay-out or reel-in rate");
    v.field("elevation_rate_radps", elevation_rate_radps, Range{0.01, 10.0},
            "largest elevation rate");
    v.field("azimuth_rate_radps", azimuth_rate_radps, Range{0.01, 10.0}, "largest azimuth rate");
    v.field("yaw_rate_radps", yaw_rate_radps, Range{0.01, 10.0}, "largest yaw rate");
    v.field("gimbal_pitch_rate_radps", gimbal_pitch_rate_radps, Range{0.01, 10.0},
            "largest gimbal pitch rate");
    v.field("tether_length_m", tether_length_m, Range{0.5, 1000.0}, "tether on the reel");
  }
};

}  // namespace tautline
