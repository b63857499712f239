// What the device makes of messages and commands.

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "drivers/test/tautline_rig.h"

namespace tautline {
namespace {

using bus::BusMode;
using testing::CanLink;
using testing::flying;
using testing::of;
using testing::Rig;
using namespace std::chrono_literals;

class TautlineDeviceTest : public testing::OverBothLinks {};

TEST_P(TautlineDeviceTest, FillsTheFrame) {
  rig_.run(50ms);
  const SensorFrame& f = rig_.frame;
  EXPECT_EQ(f.reel.sequence, 5U);
  EXPECT_TRUE(f.reel.valid);
  EXPECT_NEAR(f.reel.value.length, 2.0, 1e-9);
  EXPECT_EQ(f.reel.value.counts, 20000.0);
  EXPECT_NEAR(f.reel.value.tension.value(), 1.5, 1e-9);
  EXPECT_NEAR(f.angles.value.theta, 0.5, 1e-9);
  EXPECT_NEAR(f.angles.value.phi, -0.25, 1e-9);
  EXPECT_FALSE(f.angles.value.altitude.has_value());
  EXPECT_TRUE(f.attitude.value.R_WB.isApprox(Eigen::Quaterniond::Identity(), 1e-9));
  EXPECT_EQ(f.vehicle.value.phase, VehiclePhase::kFlying);
  EXPECT_EQ(f.vehicle.value.flags, bus::kLowBattery);
  EXPECT_NEAR(f.ground.value.battery_voltage, 15.0, 1e-9);
  EXPECT_NEAR(f.gimbal.value.pitch, -0.3, 1e-9);
  EXPECT_TRUE(f.link.connected);
  EXPECT_EQ(f.link.lines_ok, 20U);
  EXPECT_EQ(f.link.lines_bad, 0U);
  EXPECT_EQ(f.link.fault, LinkFault::kNone);
  EXPECT_LE(f.reel.time, rig_.now);
}

TEST_P(TautlineDeviceTest, NotEngagedItSendsNothingButRest) {
  VehicleCommand command = flying();
  command.engaged = false;
  command.length_rate = command.elevation_rate = command.azimuth_rate = command.yaw_rate = 0.1;
  command.gimbal_pitch_rate = 0.1;
  command.action = VehicleAction::kTakeoff;
  const auto sent = rig_.run(1s, command);
  EXPECT_EQ(of<bus::Rates>(sent).size(), 100U);
  for (const bus::Rates& r : of<bus::Rates>(sent)) {
    EXPECT_EQ(r.length, 0.0);
    EXPECT_EQ(r.elevation, 0.0);
    EXPECT_EQ(r.azimuth, 0.0);
    EXPECT_EQ(r.yaw, 0.0);
  }
  EXPECT_EQ(of<bus::ModeCommand>(sent).size(), 10U);
  for (const bus::ModeCommand& m : of<bus::ModeCommand>(sent)) {
    EXPECT_EQ(m.mode, BusMode::kDisarmed);
    EXPECT_FALSE(m.reel_controller);
    EXPECT_EQ(m.gimbal_pitch, 0.0);
  }
}

TEST_P(TautlineDeviceTest, SendsRatesEveryCycleAndTheModeOnChange) {
  VehicleCommand command = flying();
  command.length_rate = 0.3;
  command.elevation_rate = 0.1;
  command.azimuth_rate = -0.05;
  command.yaw_rate = 9.0;
  command.gimbal_pitch_rate = 0.15;
  auto sent = rig_.run(1s, command);
  const auto rates = of<bus::Rates>(sent);
  ASSERT_EQ(rates.size(), 100U);
  EXPECT_NEAR(rates.back().length, 0.3, 1e-9);
  EXPECT_NEAR(rates.back().elevation, 0.1, 1e-9);
  EXPECT_NEAR(rates.back().azimuth, -0.05, 1e-9);
  EXPECT_NEAR(rates.back().yaw, bus::kMaxAngleRate, 1e-9);
  const auto modes = of<bus::ModeCommand>(sent);
  EXPECT_EQ(modes.size(), 10U);
  EXPECT_EQ(modes.back().mode, BusMode::kArmed);
  EXPECT_TRUE(modes.back().reel_controller);
  EXPECT_NEAR(modes.back().gimbal_pitch, 0.15, 1e-9);
  unsigned alive = bus::parse(sent.front()).alive;
  for (const BusFrame& frame : sent) {
    if (frame.id != bus::kRatesId) continue;
    EXPECT_EQ(bus::parse(frame).alive, alive++ % 16);
  }
  command.action = VehicleAction::kTakeoff;
  sent = rig_.run(10ms, command);
  ASSERT_EQ(of<bus::ModeCommand>(sent).size(), 1U);
  EXPECT_EQ(of<bus::ModeCommand>(sent)[0].mode, BusMode::kTakeoff);
}

TEST_P(TautlineDeviceTest, LandIsTheVehiclesOwnLanding) {
  VehicleCommand command = flying();
  command.action = VehicleAction::kLand;
  const auto modes = of<bus::ModeCommand>(rig_.run(1s, command));
  ASSERT_EQ(modes.size(), 10U);
  for (const bus::ModeCommand& m : modes) EXPECT_EQ(m.mode, BusMode::kLand);
}

TEST_P(TautlineDeviceTest, MotorStopGoesOutAtOnceAlsoDisengaged) {
  rig_.run(20ms);
  VehicleCommand command;
  command.action = VehicleAction::kMotorStop;
  const auto modes = of<bus::ModeCommand>(rig_.run(10ms, command));
  ASSERT_EQ(modes.size(), 1U);
  EXPECT_EQ(modes[0].mode, BusMode::kStop);
  EXPECT_EQ(of<bus::ModeCommand>(rig_.run(10ms))[0].mode, BusMode::kDisarmed);
}

TEST_P(TautlineDeviceTest, SendsNothingThatIsNotFinite) {
  VehicleCommand command = flying();
  command.length_rate = std::numeric_limits<double>::quiet_NaN();
  command.elevation_rate = std::numeric_limits<double>::infinity();
  const auto rates = of<bus::Rates>(rig_.run(20ms, command));
  ASSERT_FALSE(rates.empty());
  EXPECT_EQ(rates.back().length, 0.0);
  EXPECT_EQ(rates.back().elevation, 0.0);
}

TEST_P(TautlineDeviceTest, EndsWithRestAndDisarmed) {
  VehicleCommand command = flying();
  command.elevation_rate = 0.1;
  rig_.run(50ms, command);
  rig_.device().shutdown(rig_.now);
  const auto sent = link_->receive();
  ASSERT_EQ(sent.size(), 2U);
  EXPECT_EQ(of<bus::Rates>(sent).at(0).elevation, 0.0);
  EXPECT_EQ(of<bus::ModeCommand>(sent).at(0).mode, BusMode::kDisarmed);
}

TEST_P(TautlineDeviceTest, CountsEachEndToEndResultAndUsesNoneOfThem) {
  rig_.run(50ms);
  rig_.silent = true;
  const std::uint32_t sequence = rig_.frame.reel.sequence;
  const BusFrame good = rig_.sensors.next(bus::Reel{30000, 0, 0}, 0);
  BusFrame garbled = rig_.sensors.next(bus::Reel{30000, 0, 0}, 0);
  garbled.data[1] ^= 0x40;
  rig_.sensors.skip(0);
  link_->send(good);
  link_->send(good);
  link_->send(garbled);
  link_->send(rig_.sensors.next(bus::Reel{40000, 0, 0}, 0));
  rig_.run(10ms);
  const LinkStatus& link = rig_.frame.link;
  EXPECT_EQ(rig_.frame.reel.sequence, sequence + 1);
  EXPECT_NEAR(rig_.frame.reel.value.length, 3.0, 1e-9);
  EXPECT_EQ(link.repeated, 1U);
  EXPECT_EQ(link.check_errors, 1U);
  EXPECT_EQ(link.wrong_sequence, 1U);
  EXPECT_EQ(link.lines_bad, 3U);
  EXPECT_EQ(link.timeouts, 0U);
  rig_.run(100ms);
  EXPECT_EQ(rig_.frame.link.timeouts, 4U);  // all four messages are missing, each told once
}

TEST_P(TautlineDeviceTest, AnImpossibleValueOrAFaultySensorInvalidates) {
  rig_.run(50ms);
  rig_.silent = true;
  link_->send(rig_.sensors.next(bus::Attitude{0.3, 0.0, 0.0, 0.0}, 2));
  rig_.run(10ms);
  EXPECT_FALSE(rig_.frame.attitude.valid);
  EXPECT_TRUE(rig_.frame.angles.valid);
  rig_.silent = false;
  rig_.status = bus::SensorStatus::kFault;
  rig_.run(20ms);
  EXPECT_TRUE(rig_.frame.attitude.valid);
  EXPECT_FALSE(rig_.frame.angles.valid);
  rig_.status = bus::SensorStatus::kGood;
  rig_.run(10ms);
  EXPECT_TRUE(rig_.frame.angles.valid);
}

TEST_P(TautlineDeviceTest, AppliesItsCalibration) {
  TautlineConfig config;
  config.length_scale = 1.1;
  config.length_offset_m = 0.5;
  config.azimuth_offset_rad = 0.4;
  Rig rig(*link_, config);
  rig.run(20ms);
  EXPECT_NEAR(rig.frame.reel.value.length, 2.7, 1e-9);
  EXPECT_NEAR(rig.frame.angles.value.phi, 0.15, 1e-9);
  const Eigen::Vector3d nose = rig.frame.attitude.value.R_WB * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(nose.x(), std::cos(0.4), 1e-9);
  EXPECT_NEAR(nose.z(), -std::sin(0.4), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Links, TautlineDeviceTest, ::testing::Values("can", "serial"),
                         testing::linkName);

TEST(TautlineDeviceOnCan, AStopThatTheBusDoesNotTakeIsSentWhenItDoes) {
  CanLink link;
  Rig rig(link);
  VehicleCommand rest = flying();
  rig.run(50ms, rest);
  while (link.port().write(bus::encode(bus::Rates{}, 0))) continue;  // nobody reads: full
  VehicleCommand stop;
  stop.action = VehicleAction::kMotorStop;
  rig.device().write(rig.now, stop);
  static_cast<void>(link.receive());
  rig.device().write(rig.now + 10ms, VehicleCommand{});
  const auto modes = of<bus::ModeCommand>(link.receive());
  ASSERT_EQ(modes.size(), 1U);
  EXPECT_EQ(modes[0].mode, BusMode::kStop);
}

}  // namespace
}  // namespace tautline
