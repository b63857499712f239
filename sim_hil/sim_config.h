#pragma once

/// @file
/// Everything about the simulated machine that can be set: config/sim.toml.

#include "common/fields.h"
#include "sim_hil/fotokite_emulator_config.h"
#include "sim_hil/reel.h"
#include "sim_hil/sensors.h"
#include "sim_hil/tether_chain.h"
#include "sim_hil/vehicle.h"
#include "sim_hil/wind.h"

namespace tautline::sim {

struct SimConfig {
  double step{0.002};        ///< Of the virtual clock [s].
  double start_slack{1e-3};  ///< Tether out at the start beyond the straight line, relative.
  TetherConfig tether;
  ReelConfig reel;
  VehicleConfig vehicle;
  WindConfig wind;
  SensorConfig sensors;
  FotokiteEmulatorConfig fotokite;

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("step_s", step, Range{0.0005, 0.01}, "of the virtual clock");
    v.field("start_slack", start_slack, Range{0, 0.5},
            "tether out at the start beyond the straight line to the reel, relative");
    v.section("tether", tether);
    v.section("reel", reel);
    v.section("vehicle", vehicle);
    v.section("wind", wind);
    v.section("sensors", sensors);
    v.section("fotokite", fotokite);
  }
};

}  // namespace tautline::sim
