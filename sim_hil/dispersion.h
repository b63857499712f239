#pragma once

/// @file
/// What differs from one flight of a machine to the next: it is set up anew and drawn from the seed
/// once, so that a campaign sees the scatter that a row of real flights has. docs/simulator.md.

#include <cstdint>

#include "common/fields.h"

namespace tautline::sim {

struct SimConfig;

/// Standard deviations of normal distributions about the configured values, which are then cut off
/// at two of them (0.88 of it is left). All zero by default: every flight has the same machine.
struct DispersionConfig {
  double tension{0.0};         ///< Of the pull on the tether [N].
  double elevation_bias{0.0};  ///< [rad]
  double azimuth_bias{0.0};    ///< [rad]
  double reel_scale{0.0};      ///< True metres per nominal metre.

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("tension_n", tension, Range{0, 5},
            "standard deviation between flights, cut off at two: of vehicle.tension_n ...");
    v.field("elevation_bias_rad", elevation_bias, Range{0, 0.2},
            "... of sensors.elevation_bias_rad ...");
    v.field("azimuth_bias_rad", azimuth_bias, Range{0, 0.5}, "... of sensors.azimuth_bias_rad ...");
    v.field("reel_scale", reel_scale, Range{0, 0.1}, "... of reel.scale");
  }
};

/// The machine of the flight with this seed, with no dispersion left. What lies beyond two standard
/// deviations would be seen before take-off and is not drawn; a pull is never negative. Gusts and
/// noise of the flight are the same with and without dispersion.
/// Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] SimConfig dispersed(const SimConfig& config, std::uint64_t seed) noexcept;

}  // namespace tautline::sim
