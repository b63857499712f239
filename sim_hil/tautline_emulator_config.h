#pragma once

/// @file
/// What can be set about the emulated devices on the Tautline bus.

#include "common/fields.h"

namespace tautline::sim {

struct TautlineEmulatorConfig {
  double sensor_rate{100.0};     ///< Of each sensor's message [Hz].
  double landing_timeout{10.0};  ///< Emergency landing without commands for this long [s].

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("sensor_rate_hz", sensor_rate, Range{1, 500},
            "of each sensor's message; agreed is 100");
    v.field("landing_timeout_s", landing_timeout, Range{0.5, 600},
            "emergency landing without commands for this long");
  }
};

}  // namespace tautline::sim
