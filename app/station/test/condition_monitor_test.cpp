#include "app/station/condition_monitor.h"

#include <bit>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "app/station/fence_scene.h"
#include "app/station/station.h"
#include "app/station/station_config.h"
#include "app/station/vehicle_signs.h"
#include "common/error.h"
#include "common/toml/config_file.h"

namespace tautline {
namespace {

using C = Condition;

VehicleReading reading(VehicleProtocol protocol, int mode, int flags) {
  VehicleReading r;
  r.protocol = protocol;
  r.flight_mode = static_cast<std::uint8_t>(mode);
  r.flags = static_cast<std::uint16_t>(flags);
  return r;
}

TEST(VehicleSigns, EveryFlagIsOneBitWithNameTextAndRemedy) {
  for (const VehicleProtocol protocol : {VehicleProtocol::kFotokite, VehicleProtocol::kTautline}) {
    std::set<std::string> names;
    unsigned all = 0;
    for (const VehicleSign& flag : flagsOf(protocol)) {
      EXPECT_EQ(std::popcount(flag.code), 1) << flag.name;
      EXPECT_EQ(all & flag.code, 0U) << flag.name;
      all |= flag.code;
      EXPECT_TRUE(names.insert(flag.name).second) << flag.name;
      EXPECT_STRNE(flag.name, "?");
      EXPECT_GT(std::string(flag.text).size(), 5U) << flag.name;
      EXPECT_GT(std::string(flag.remedy).size(), 5U) << flag.name;
    }
    EXPECT_EQ(names.size(), protocol == VehicleProtocol::kFotokite ? 13U : 5U);
  }
}

TEST(VehicleSigns, WhatFlagsAndModesAskFor) {
  struct Case {
    VehicleProtocol protocol;
    int mode;
    int flags;
    ConditionSet expected;
  };
  const auto fotokite = VehicleProtocol::kFotokite;
  const auto bus = VehicleProtocol::kTautline;
  const Case cases[] = {
      {fotokite, 2, 0, {}},
      {fotokite, 2, 1 << 0, {C::kVehicleWarning}},
      {fotokite, 2, 1 << 5, {C::kVehicleFault}},
      {fotokite, 2, (1 << 6) | (1 << 7), {C::kBatteryLow, C::kBackupBatteryLow}},
      {fotokite, 2, 1 << 9, {C::kTetherSlack}},
      {fotokite, 2, 1 << 10, {C::kVehicleDanger}},
      {fotokite, 48, 0, {C::kVehicleFault}},
      {fotokite, 53, 0, {C::kBatteryCritical}},
      {fotokite, 54, 0, {C::kTetherPowerLost}},
      {fotokite, 55, 0, {C::kVehicleDanger}},
      {fotokite, 77, 0, {C::kVehicleWarning}},
      {bus, 2, 0, {}},
      {bus, 5, 0, {C::kVehicleFault}},
      {bus, 2, 3, {C::kBatteryLow, C::kBatteryCritical}},
      {bus, 2, 1 << 4, {C::kVehicleFault}},
      {VehicleProtocol::kUnknown, 55, 0xFFFF, {}},
  };
  for (const Case& c : cases)
    EXPECT_EQ(conditionsOf(reading(c.protocol, c.mode, c.flags)), c.expected)
        << "mode " << c.mode << " flags " << c.flags;
  VehicleReading recorded;
  recorded.phase = VehiclePhase::kFault;
  EXPECT_EQ(conditionsOf(recorded), ConditionSet{C::kVehicleFault});
}

Scene sceneWith(std::size_t boxes, std::size_t corners) {
  Scene scene;
  for (std::size_t i = 0; i < boxes; ++i)
    scene.boxes.push_back({"box", {0, 0, 0}, {1, 1, 1}, false});
  Prism prism{"prism", {}, 0.0, 1.0, false};
  for (std::size_t i = 0; i < corners; ++i)
    prism.footprint.emplace_back(std::cos(0.1 * static_cast<double>(i)),
                                 std::sin(0.1 * static_cast<double>(i)));
  scene.prisms.push_back(prism);
  return scene;
}

TEST(FenceScene, ObstaclesComeBackThroughTheConfiguration) {
  CoreConfig config;
  const Scene scene = sceneWith(2, 5);
  config.fence.obstacles = fenceObstaclesOf(scene);
  const auto back = parseConfig<CoreConfig>(dumpConfig(config), "dump");
  ASSERT_EQ(back.fence.obstacles.all().size(), 3U);
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(2, 0.5, 0.5), {0.5, 0.5, 0.5}, {-1, 3, 0.2}, {0.9, 0.1, 1.7}})
    EXPECT_EQ(clearance(p, back.fence.obstacles), clearance(p, scene));
}

TEST(FenceScene, MoreThanThereIsRoomForIsRefused) {
  EXPECT_NO_THROW((void)fenceObstaclesOf(sceneWith(63, 32)));
  EXPECT_THROW((void)fenceObstaclesOf(sceneWith(64, 32)), InputError);
  EXPECT_THROW((void)fenceObstaclesOf(sceneWith(1, 33)), InputError);
}

TEST(ConditionMonitor, AConfigurationThatCannotFlyForbidsArming) {
  const auto bad = [](void (*change)(CoreConfig&)) {
    auto config = std::make_unique<CoreConfig>();
    change(*config);
    Station station(*config);
    StepInput in;
    in.now = Time{} + std::chrono::seconds(1);
    return station.step(in).conditions.has(C::kConfigBad);
  };
  EXPECT_FALSE(bad([](CoreConfig&) {}));
  EXPECT_TRUE(bad([](CoreConfig& c) { c.fence.max_height_m = 0.5; }));
  EXPECT_TRUE(bad([](CoreConfig& c) { c.limits.tether_length_m = 0.5; }));
  EXPECT_TRUE(bad([](CoreConfig& c) { c.detect.tether.max_tension_n = 0.2; }));
  EXPECT_TRUE(bad([](CoreConfig& c) { c.detect.power.battery_critical_v = 12.0; }));
  EXPECT_TRUE(bad([](CoreConfig& c) { c.fence.keep_out.add({{0, 0, 0}, {2, 2, 2}}); }));
}

TEST(ConditionMonitor, TheMachineForbidsArmingInARealRunOnly) {
  for (const RunMode run : {RunMode::kReal, RunMode::kHil}) {
    Station station(CoreConfig{});
    StepInput in;
    in.host.run_mode = run;
    in.host.device = run == RunMode::kReal ? DeviceReality::kEmulated : DeviceReality::kUnknown;
    ConditionSet seen;
    for (int i = 0; i < 400; ++i) {
      in.now = Time{} + std::chrono::milliseconds(10 * (i + 1));
      seen = station.step(in).conditions;
    }
    constexpr ConditionSet kHost{C::kRealTimeMissing, C::kLogOff, C::kSimMismatch};
    EXPECT_EQ(seen & kHost, run == RunMode::kReal ? kHost : ConditionSet{});
  }
}

}  // namespace
}  // namespace tautline
