#pragma once

/// @file
/// What can be set about the emulated ground station.

#include "common/fields.h"

namespace tautline::sim {

struct FotokiteEmulatorConfig {
  double default_rate{1.0};       ///< Telemetry until parameter 117 is set [Hz].
  double max_rate{100.0};         ///< Parameter 117 is cut to this [Hz].
  double forced_rate{0.0};        ///< Not 0: telemetry at this rate whatever is asked for [Hz].
  double status_rate{10.0};       ///< Most !Gimbal and !FlightStatus lines a second [Hz].
  double angle_resolution{0.01};  ///< Of the angles in !Pos [rad]; the real device has 0.01.
  double low_launch_angle{
      -0.35};                    ///< Flag LOW_LAUNCH_ANGLE at take-off below this elevation [rad].
  double slack_tension{0.15};    ///< Flag NO_TETHER_DETECTED below this pull at the vehicle [N].
  double command_timeout{0.5};   ///< Set-points are held without commands for this long [s].
  double landing_timeout{10.0};  ///< Emergency landing without commands for this long [s].

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("default_rate_hz", default_rate, Range{0.1, 100},
            "telemetry until parameter 117 is set");
    v.field("max_rate_hz", max_rate, Range{0.1, 500}, "parameter 117 is cut to this");
    v.field("forced_rate_hz", forced_rate, Range{0, 500}, "not 0: whatever is asked for");
    v.field("status_rate_hz", status_rate, Range{0.1, 500}, "most !Gimbal and !FlightStatus lines");
    v.field("angle_resolution_rad", angle_resolution, Range{1e-5, 0.1}, "of the angles in !Pos");
    v.field("low_launch_angle_rad", low_launch_angle, Range{-1.5, 1.5},
            "flag LOW_LAUNCH_ANGLE at take-off below this elevation");
    v.field("slack_tension_n", slack_tension, Range{0, 10},
            "flag NO_TETHER_DETECTED below this pull at the vehicle for 0.3 s");
    v.field("command_timeout_s", command_timeout, Range{0.1, 60},
            "set-points are held without commands for this long");
    v.field("landing_timeout_s", landing_timeout, Range{0.5, 600},
            "emergency landing without commands for this long");
  }
};

}  // namespace tautline::sim
