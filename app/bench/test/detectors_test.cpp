// The detectors against the simulated machine: no false alarm in any shipped mission, and each
// situation that the plant can make is found.

#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "app/bench/lockstep.h"
#include "app/bench/test/bench_flight.h"

namespace tautline::bench {
namespace {

using C = Condition;
using std::chrono::seconds;

/// What must not come in a flight in which nothing is wrong. Where the tether stands upright, the
/// two warnings about it are right.
constexpr ConditionSet kAlarms =
    (conditionsOf(ConditionKind::kInFlight) | conditionsOf(ConditionKind::kForbidsArming) |
     conditionsOf(ConditionKind::kWarns))
        .without(ConditionSet{C::kVehicleFlying, C::kNoOperator, C::kTensionUnobservable,
                              C::kElevationHigh});

/// Everything that counted while the motors were on, and the first alarm for whoever has to find
/// out why.
struct Seen {
  ConditionSet counted;
  std::string first_alarm;

  void look(const Lockstep& bench) {
    if (!bench.truth().motors_on) return;
    const StepOutput& out = bench.output();
    counted = counted | out.conditions;
    const ConditionSet alarms = out.conditions & kAlarms;
    if (alarms.empty() || !first_alarm.empty()) return;
    std::ostringstream text;
    text << describe(alarms) << " at " << toSeconds(bench.now().time_since_epoch())
         << " s, waypoint " << out.mission.waypoint << ", contact " << out.contact_id
         << ", estimate " << out.estimate.p_WD.transpose() << ", truth "
         << bench.truth().p_WD.transpose();
    for (const ConditionInfo& info : kConditionInfos) {
      if (alarms.has(info.condition))
        text << ", " << out.findings.valueOf(info.condition) << " of "
             << out.findings.limitOf(info.condition);
    }
    first_alarm = text.str();
  }
};

struct Shipped {
  const char* mission;
  const char* scene;
};
constexpr Shipped kShipped[] = {{"square", "open"},
                                {"path1_0.2", "open"},
                                {"path1_0.5", "open"},
                                {"path1_1", "open"},
                                {"path1_1.5", "open"},
                                {"path1_3", "open"},
                                {"path2_0.2", "open"},
                                {"path2_0.5", "open"},
                                {"path2_1", "open"},
                                {"path2_1.5", "open"},
                                {"path2_3", "open"},
                                {"one_contact", "one_contact"},
                                {"two_contacts", "two_contacts"}};

class NoFalseAlarm : public ::testing::TestWithParam<Shipped> {};

TEST_P(NoFalseAlarm, InAShippedMission) {
  const Shipped shipped = GetParam();
  const Mission plan = mission(shipped.mission);
  for (const bool bus : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      LockstepConfig config =
          bus ? busConfig(shipped.scene, seed) : benchConfig(shipped.scene, seed);
      Lockstep bench(config, nullptr);
      Seen seen;
      const FlightResult r =
          flyMission(bench, *plan.plan, seconds(900), [&](const Lockstep& b) { seen.look(b); });
      const std::string which = (bus ? "bus, seed " : "Fotokite, seed ") + std::to_string(seed);
      EXPECT_TRUE(r.completed && r.landed) << which;
      EXPECT_EQ(seen.first_alarm, "") << which;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Shipped, NoFalseAlarm, ::testing::ValuesIn(kShipped),
                         [](const auto& param_info) {
                           std::string name = param_info.param.mission;
                           for (char& c : name) c = c == '.' ? '_' : c;
                           return name;
                         });

/// Flies a mission in which something is wrong; what counted while the motors were on, and how it
/// ended.
struct Flown {
  Seen seen;
  FlightResult result;
  Mode last{Mode::kStandby};  ///< While the motors ran.
};
Flown fly(const LockstepConfig& config, const MissionPlan& plan,
          const std::function<void(Lockstep&)>& meddle = {}) {
  Lockstep bench(config, nullptr);
  Flown out;
  out.result = flyMission(bench, plan, seconds(120), [&](const Lockstep& b) {
    out.seen.look(b);
    if (b.truth().motors_on) out.last = b.output().supervision.mode;
    if (meddle) meddle(bench);
  });
  return out;
}
MissionPlan square() { return *mission("square").plan; }

TEST(Detectors, Unplugged) {
  const Flown f = fly(benchConfig("open", 1), square(), [](Lockstep& b) {
    const double t = toSeconds(b.now().time_since_epoch());
    if (t > 20.0 && t < 22.0) b.port().unplug();
    if (t >= 22.0) b.port().plug();
  });
  EXPECT_TRUE(f.seen.counted.all({C::kLinkLost, C::kReelStale, C::kAnglesStale, C::kVehicleStale}));
  EXPECT_FALSE(f.seen.counted.any({C::kReelJump, C::kAnglesJump}))
      << "what comes back after an outage is no jump";
}

TEST(Detectors, GarbledBytes) {
  for (const bool bus : {false, true}) {
    const Flown f =
        fly(bus ? busConfig("open", 1) : benchConfig("open", 1), square(), [](Lockstep& b) {
          if (b.now() > Time{} + seconds(20)) b.port().garble(97);
        });
    EXPECT_TRUE(f.seen.counted.has(C::kCrcRate)) << (bus ? "bus" : "Fotokite");
  }
}

TEST(Detectors, BatteryLowComesHomeAndCriticalLands) {
  LockstepConfig config = benchConfig("open", 1);
  config.sim.vehicle.battery = 11.4;
  config.sim.vehicle.battery_life = 200.0;
  Flown f = fly(config, square());
  EXPECT_TRUE(f.seen.counted.has(C::kBatteryLow));
  config.sim.vehicle.battery = 11.2;
  config.sim.vehicle.battery_life = 15.0;
  f = fly(config, square());
  EXPECT_TRUE(f.seen.counted.has(C::kBatteryCritical));
}

TEST(Detectors, AnEmptyBatteryForbidsArming) {
  LockstepConfig config = benchConfig("open", 1);
  config.sim.vehicle.battery = 11.0;
  EXPECT_FALSE(fly(config, square()).result.armed);
}

TEST(Detectors, EndOfTheReelStopsPayOut) {
  LockstepConfig config = benchConfig("open", 1);
  config.station.core.limits.tether_length_m = 3.2;
  config.station.core.detect.tether.reel_margin_m = 1.0;
  double longest = 0.0;
  const Flown f =
      fly(config, square(), [&](Lockstep& b) { longest = std::max(longest, b.truth().length); });
  EXPECT_TRUE(f.seen.counted.has(C::kReelLimit));
  EXPECT_LT(longest, 2.3);
}

TEST(Detectors, FenceOfLengthHeightAndKeepOut) {
  struct Case {
    C condition;
    void (*set)(FenceConfig&);
  };
  const Case cases[] = {{C::kFenceLength, [](FenceConfig& f) { f.max_length_m = 2.2; }},
                        {C::kFenceAltitude, [](FenceConfig& f) { f.max_height_m = 1.1; }},
                        {C::kFenceElevation, [](FenceConfig& f) { f.min_elevation_rad = 0.6; }},
                        {C::kFenceKeepOut, [](FenceConfig& f) {
                           f.keep_out.add({{0.4, -1, 1.5}, {2, 3, 3}});
                         }}};
  for (const Case& c : cases) {
    LockstepConfig config = benchConfig("open", 1);
    c.set(config.station.core.fence);
    const Flown f = fly(config, square());
    EXPECT_TRUE(f.result.took_off) << infoOf(c.condition).name;
    EXPECT_TRUE(f.seen.counted.has(c.condition)) << infoOf(c.condition).name;
    EXPECT_FALSE(f.result.completed) << infoOf(c.condition).name;
  }
}

TEST(Detectors, ClearanceToAnObstacleOfTheMap) {
  LockstepConfig config = benchConfig("open", 1);
  config.world.boxes.push_back({"post", {1.0, -0.3, 1.6}, {1.3, 2.0, 1.9}, false});
  config.station.core.fence.min_clearance_m = 0.3;
  const Flown f = fly(config, square());
  EXPECT_TRUE(f.seen.counted.has(C::kFenceClearance));
  EXPECT_EQ(f.result.crash, sim::CrashReason::kNone) << "stopped before it touched";
}

TEST(Detectors, AContactThatTheMissionDoesNotKnow) {
  MissionPlan plan = *mission("two_contacts").plan;
  for (Waypoint& w : plan.waypoints) w.contact = kReelContact;
  const Flown f = fly(benchConfig("two_contacts", 1), plan);
  EXPECT_TRUE(f.seen.counted.has(C::kUnplannedContact)) << f.seen.first_alarm;
  EXPECT_EQ(f.result.crash, sim::CrashReason::kNone);
}

TEST(Detectors, ASlackTether) {
  for (const bool bus : {false, true}) {
    LockstepConfig config = bus ? busConfig("open", 1) : benchConfig("open", 1);
    config.sim.vehicle.tension = 0.02;
    config.sim.wind.gust = 0.0;
    const Flown f = fly(config, square());
    EXPECT_TRUE(f.seen.counted.has(C::kTetherSlack)) << (bus ? "bus" : "Fotokite");
  }
}

TEST(Detectors, OverTension) {
  for (const bool bus : {false, true}) {
    LockstepConfig config = bus ? busConfig("open", 1) : benchConfig("open", 1);
    config.sim.vehicle.tension = 6.0;
    const Flown f = fly(config, square());
    EXPECT_TRUE(f.seen.counted.has(C::kOverTension)) << (bus ? "bus" : "Fotokite");
  }
}

TEST(Detectors, AnOscillatingVehicle) {
  LockstepConfig config = benchConfig("open", 1);
  config.sim.vehicle.damping = 0.05;
  const Flown f = fly(config, square());
  EXPECT_TRUE(f.seen.counted.has(C::kOscillation));
}

TEST(Detectors, AWrongReelOrAzimuthForbidsArming) {
  LockstepConfig config = benchConfig("open", 1);
  config.sim.reel.scale = 1.5;
  Flown f = fly(config, square());
  EXPECT_FALSE(f.result.armed);
  config = benchConfig("open", 1);
  config.sim.sensors.azimuth_bias = 0.5;
  f = fly(config, square());
  EXPECT_FALSE(f.result.armed);
}

TEST(Detectors, AnElevationThatHidesTheTensionIsTold) {
  LockstepConfig config = benchConfig("open", 1);
  config.station.core.detect.tether.elevation_high_rad = 1.3;
  config.station.core.detect.tether.least_lean_angle_rad = 0.3;
  const Flown f = fly(config, *mission("path2_0.5").plan);
  EXPECT_TRUE(f.seen.counted.all({C::kTensionUnobservable, C::kElevationHigh}));
}

}  // namespace
}  // namespace tautline::bench
