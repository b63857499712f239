#pragma once

/// @file
/// A localizer that follows a generated flight, and the errors it makes.

#include <cmath>

#include <gtest/gtest.h>

#include "estimation/localizer.h"
#include "estimation/test/flight_generator.h"

namespace tautline::testing {

/// The reference device: 0.01 rad, 2.85 mm a count.
inline FlightOptions deviceFlight(double rate) {
  FlightOptions o;
  o.rate = rate;
  o.angle_quantum = 0.01;
  o.length_quantum = 0.00285;
  o.altitude_sigma = 0.1;
  o.lean_sigma = 0.02;
  o.velocity_sigma = 0.05;
  return o;
}

inline LocalizerConfig configFor(const FlightOptions& o) {
  LocalizerConfig config;
  config.nominal_tension_n = o.T_nominal;
  return config;
}

/// A localizer that follows a generated flight.
class Flight {
 public:
  Flight(const FlightOptions& options, const LocalizerConfig& config)
      : generator(options), localizer(config) {
    localizer.reset(generator.truePosition(), generator.now());
  }

  Estimate step() {
    generator.step();
    estimate = localizer.update(generator.now(), generator.frame(), generator.lastCommand(),
                                generator.anchor());
    return estimate;
  }

  struct Errors {
    double mean{0.0};
    double worst{0.0};
  };
  /// Flies on; errors of position against truth, once every ten cycles.
  Errors fly(double seconds) {
    Errors errors;
    int count = 0;
    const int cycles = static_cast<int>(seconds / FlightGenerator::kCycle);
    for (int i = 0; i < cycles; ++i) {
      step();
      EXPECT_TRUE(isFinite(estimate));
      if (i % 10 != 0) continue;
      const double error = (estimate.p_WD - generator.truePosition()).norm();
      errors.mean += error;
      errors.worst = std::fmax(errors.worst, error);
      ++count;
    }
    errors.mean /= count;
    return errors;
  }

  static bool isFinite(const Estimate& e) {
    return e.p_WD.allFinite() && e.v_WD.allFinite() && e.P_position.allFinite() &&
           std::isfinite(e.L_free) && std::isfinite(e.theta_tangent) && std::isfinite(e.phi) &&
           std::isfinite(e.T) && std::isfinite(e.sigma_T) && std::isfinite(e.nis);
  }

  FlightGenerator generator;
  Localizer localizer;
  Estimate estimate;
};

}  // namespace tautline::testing
