#pragma once

/// @file
/// Everything that can be set on the station, in one file (config/station.toml); each part
/// documents its own fields.

#include <array>
#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "app/station/replay_device.h"
#include "common/error.h"
#include "common/fields.h"
#include "common/realtime.h"
#include "common/vehicle.h"
#include "control/command_gate.h"
#include "control/control_config.h"
#include "control/motion_executor.h"
#include "control/reel_dead_zone.h"
#include "control/vehicle_limits.h"
#include "drivers/can_socket.h"
#include "drivers/fotokite_device.h"
#include "drivers/serial_port.h"
#include "drivers/tautline_device.h"
#include "estimation/contact_observer.h"
#include "estimation/localizer.h"
#include "supervision/authority_config.h"
#include "supervision/detect/detect_config.h"
#include "supervision/detect/fence.h"
#include "supervision/supervisor.h"

namespace tautline {

/// Take-off, ways back and landing.
struct GuidanceConfig {
  Eigen::Vector3d home_position_m{0.7, -0.2, 0.4};
  double takeoff_height_m{0.9};
  double takeoff_radius_m{0.3};
  double approach_height_m{0.5};
  double travel_speed_mps{0.3};
  double descent_speed_mps{0.15};
  double touchdown_height_m{0.3};
  double action_period_s{1.0};
  double back_up_m{1.0};
  double slack_reel_in_mps{0.05};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field(
        "home_position_m", home_position_m, Range{-1000, 1000},
        "drone's tether attachment when parked, from the reel outlet; a scene's start replaces it");
    v.field("takeoff_height_m", takeoff_height_m, Range{0.2, 10},
            "height of the first hover above home");
    v.field("takeoff_radius_m", takeoff_radius_m, Range{0.05, 2},
            "take-off ends this close to the hover point");
    v.field("approach_height_m", approach_height_m, Range{0.1, 10},
            "landing descends from this height above home");
    v.field("travel_speed_mps", travel_speed_mps, Range{0.01, 5},
            "speed to the hover point and back home");
    v.field("descent_speed_mps", descent_speed_mps, Range{0.05, 2}, "speed of the last descent");
    v.field("touchdown_height_m", touchdown_height_m, Range{0.1, 1},
            "below this height above home it may stand: on the ground once it comes no lower");
    v.field("action_period_s", action_period_s, Range{0.1, 10},
            "take-off and motor stop are repeated this often");
    v.field("back_up_m", back_up_m, Range{0.1, 100}, "way back along the flown path in BACKUP");
    v.field("slack_reel_in_mps", slack_reel_in_mps, Range{0.0, 1},
            "reel-in in FAILSAFE while the tether is slack");
  }

  /// So low that it may stand on the floor. Real-time safe: no allocation, no locks, no exceptions.
  [[nodiscard]] bool isNearFloor(const Eigen::Vector3d& p_WD) const noexcept {
    return p_WD.y() < home_position_m.y() + touchdown_height_m;
  }
};

/// The pure core.
struct CoreConfig {
  GuidanceConfig guidance;
  LocalizerConfig localizer;
  ContactObserverConfig contact_observer;
  DetectConfig detect;
  FenceConfig fence;
  SupervisorConfig supervisor;
  AuthorityConfig authority;
  ExecutorConfig executor;
  ControlConfig control;
  VehicleLimits limits;
  CommandGateConfig gate;
  ReelDeadZoneConfig reel_dead_zone;
  int overruns_in_a_row{5};

  template <class Visitor>
  void fields(Visitor& v) {
    v.section("guidance", guidance);
    v.section("localizer", localizer);
    v.section("contact_observer", contact_observer);
    v.section("detect", detect);
    v.section("fence", fence);
    v.section("supervisor", supervisor);
    v.section("authority", authority);
    v.section("executor", executor);
    v.section("control", control);
    v.section("limits", limits);
    v.section("gate", gate);
    v.section("reel_dead_zone", reel_dead_zone);
    v.field("overruns_in_a_row", overruns_in_a_row, Range{1, 1000},
            "this many ticks missed in a row end a mission");
  }
};

enum class RealTimePolicy : std::uint8_t {
  kIgnore,   ///< Go on without what the machine does not allow, and say so.
  kEnforce,  ///< Refuse to start.
};
inline constexpr std::array<EnumName<RealTimePolicy>, 2> kRealTimePolicyNames{
    {{RealTimePolicy::kIgnore, "ignore"}, {RealTimePolicy::kEnforce, "enforce"}}};

/// What the station flies.
enum class DeviceKind : std::uint8_t {
  kFotokite,        ///< Fotokite Pro ground station on `serial`.
  kTautlineCan,     ///< Tautline bus on `can`.
  kTautlineSerial,  ///< Tautline bus on `serial`.
  kReplay,          ///< A recording: nothing moves.
};
inline constexpr std::array<EnumName<DeviceKind>, 4> kDeviceKindNames{
    {{DeviceKind::kFotokite, "fotokite"},
     {DeviceKind::kTautlineCan, "tautline-can"},
     {DeviceKind::kTautlineSerial, "tautline-serial"},
     {DeviceKind::kReplay, "replay"}}};

struct StationConfig {
  RunMode run_mode{RunMode::kReal};
  DeviceKind device{DeviceKind::kFotokite};
  double loop_rate_hz{100.0};
  double telemetry_rate_hz{20.0};
  std::string black_box{"/dev/shm/tautline-station.blackbox"};
  RealTimePolicy realtime_policy{RealTimePolicy::kIgnore};
  int realtime_priority{50};
  int realtime_cpu{-1};
  SerialConfig serial;
  CanConfig can;
  FotokiteConfig fotokite;
  TautlineConfig tautline;
  ReplayConfig replay;
  CoreConfig core;

  template <class Visitor>
  void fields(Visitor& v) {
    v.choice("run_mode", run_mode, kRunModeNames, "what this station is part of");
    v.choice("device", device, kDeviceKindNames, "what the station flies");
    v.field("loop_rate_hz", loop_rate_hz, Range{10, 1000}, "cycles a second");
    v.field("telemetry_rate_hz", telemetry_rate_hz, Range{1, 1000}, "state messages a second");
    v.field("black_box", black_box, "file of the last cycles; empty: none");
    v.choice("realtime_policy", realtime_policy, kRealTimePolicyNames,
             "what to do where the machine refuses real-time rights");
    v.field("realtime_priority", realtime_priority, Range{0, 98},
            "SCHED_FIFO priority; 0 leaves the scheduler alone");
    v.field("realtime_cpu", realtime_cpu, Range{-1, 1023}, "processor of the loop; -1: any");
    v.section("serial", serial);
    v.section("can", can);
    v.section("fotokite", fotokite);
    v.section("tautline", tautline);
    v.section("replay", replay);
    v.section("core", core);
  }

  /// Throws InputError for what a single range cannot say.
  void validate() const {
    if (run_mode != RunMode::kReal) return;
    if (device == DeviceKind::kReplay) {
      throw InputError({.key = "run_mode",
                        .problem = "is REAL, and a recording moves nothing",
                        .allowed = "SIM or HIL with device = \"replay\"",
                        .remedy = "set run_mode = \"SIM\""});
    }
    if (!core.detect.vehicle_signs) {
      throw InputError({.key = "core.detect.vehicle_signs",
                        .problem = "is false, and a real vehicle's faults must be acted on",
                        .allowed = "true, or run_mode SIM or HIL",
                        .remedy = "leave the key out"});
    }
  }
};

}  // namespace tautline
