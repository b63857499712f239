#pragma once

/// @file
/// Everything about the simulated machine that can be set: config/sim.toml.

#include <array>
#include <cstdint>

#include "common/fields.h"
#include "sim_hil/dispersion.h"
#include "sim_hil/fotokite_emulator_config.h"
#include "sim_hil/reel.h"
#include "sim_hil/sensors.h"
#include "sim_hil/tautline_emulator_config.h"
#include "sim_hil/tether_chain.h"
#include "sim_hil/vehicle.h"
#include "sim_hil/wind.h"

namespace tautline::sim {

/// What stands between the plant and the station.
enum class SimDevice : std::uint8_t {
  kFotokite,        ///< Text lines.
  kTautlineSerial,  ///< COBS frames.
  kTautlineSlcan,   ///< Text of a CAN adapter on a serial line.
  kTautlineCan,     ///< The kernel's can_frame records.
};
inline constexpr std::array<EnumName<SimDevice>, 4> kSimDeviceNames{
    {{SimDevice::kFotokite, "fotokite"},
     {SimDevice::kTautlineSerial, "tautline-serial"},
     {SimDevice::kTautlineSlcan, "tautline-slcan"},
     {SimDevice::kTautlineCan, "tautline-can"}}};

struct SimConfig {
  SimDevice device{SimDevice::kFotokite};
  double step{0.002};        ///< Of the virtual clock [s].
  double start_slack{1e-3};  ///< Tether out at the start beyond the straight line, relative.
  TetherConfig tether;
  ReelConfig reel;
  VehicleConfig vehicle;
  WindConfig wind;
  SensorConfig sensors;
  DispersionConfig dispersion;
  FotokiteEmulatorConfig fotokite;
  TautlineEmulatorConfig tautline;

  template <class Visitor>
  void fields(Visitor& v) {
    v.choice(
        "device", device, kSimDeviceNames,
        "what the station talks to; on the Tautline bus the reel counts tenths of a millimetre");
    v.field("step_s", step, Range{0.0005, 0.01}, "of the virtual clock");
    v.field("start_slack", start_slack, Range{0, 0.5},
            "tether out at the start beyond the straight line to the reel, relative");
    v.section("tether", tether);
    v.section("reel", reel);
    v.section("vehicle", vehicle);
    v.section("wind", wind);
    v.section("sensors", sensors);
    v.section("dispersion", dispersion);
    v.section("fotokite", fotokite);
    v.section("tautline", tautline);
  }
};

}  // namespace tautline::sim
