#include "drivers/fotokite_device.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/tether_geometry.h"
#include "drivers/serial_port.h"
#include "drivers/test/pty.h"
#include "drivers/test/text_fields.h"

namespace tautline {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::Pty;
using testing::readTextLine;
using ::testing::StartsWith;
using namespace std::chrono_literals;

constexpr double kPi = std::numbers::pi;

// The whole start sequence as docs/devices.md has it.
const std::vector<std::string> kStartSequence{"stop",
                                              "",
                                              "",
                                              "",
                                              "",
                                              "",
                                              "GSLowControl params 2 2",
                                              "RemoteControl start",
                                              "Checksum 0",
                                              "Pset 117,10.0",
                                              "Pcommit",
                                              "Pset 119,0",
                                              "Pcommit",
                                              "Get_GroundStatus 0",
                                              "Get_Att 0",
                                              "Get_Pos 0",
                                              "Get_FlightStatus 0",
                                              "Get_Gimbal 0"};

SerialConfig configFor(const std::string& path) {
  SerialConfig config;
  config.device = path;
  return config;
}

VehicleCommand flying() {
  VehicleCommand command;
  command.engaged = true;
  command.reel_controller = true;
  return command;
}

// A station loop at 100 Hz on virtual time, with the device's side of the line played by the test.
class FotokiteDeviceTest : public ::testing::Test {
 protected:
  static constexpr Duration kPeriod = 10ms;

  explicit FotokiteDeviceTest(const FotokiteConfig& config = {})
      : port_(configFor(pty_.path())), device_(port_, config) {
    EXPECT_TRUE(port_.open());
  }

  // Runs the loop for `duration`; what the device sent meanwhile.
  std::vector<std::string> run(Duration duration, const VehicleCommand& command = {}) {
    std::vector<std::string> lines;
    for (const Time end = now_ + duration; now_ < end; now_ += kPeriod) {
      device_.read(now_, frame_);
      device_.write(now_, command);
      if (pty_.master() < 0) continue;
      for (std::string& line : pty_.receiveLines()) lines.push_back(std::move(line));
    }
    return lines;
  }

  std::vector<std::string> start() {
    std::vector<std::string> lines;
    while (!device_.started()) {
      for (std::string& line : run(kPeriod)) lines.push_back(std::move(line));
    }
    return lines;
  }

  void receive(const std::string& text) {
    pty_.send(text);
    device_.read(now_, frame_);
  }

  Pty pty_;
  SerialPort port_;
  FotokiteDevice device_;
  SensorFrame frame_;
  Time now_{5s};
};

std::vector<std::string> named(const std::vector<std::string>& lines, const std::string& name) {
  std::vector<std::string> out;
  std::copy_if(lines.begin(), lines.end(), std::back_inserter(out), [&](const std::string& line) {
    return readTextLine(line) && readTextLine(line)->name == name;
  });
  return out;
}

std::vector<double> lastFields(const std::vector<std::string>& lines, const std::string& name) {
  const std::vector<std::string> matching = named(lines, name);
  return matching.empty() ? std::vector<double>{} : readTextLine(matching.back())->fields;
}

TEST_F(FotokiteDeviceTest, StartsRemoteControlOneLineACycleAndNothingElse) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < kStartSequence.size(); ++i) {
    EXPECT_FALSE(device_.started());
    const auto lines = run(kPeriod, flying());
    ASSERT_EQ(lines.size(), 1U);
    all.push_back(lines.front());
  }
  EXPECT_THAT(all, ElementsAreArray(kStartSequence));
  EXPECT_TRUE(device_.started());
}

TEST_F(FotokiteDeviceTest, HoldsWhenNotEngagedWhateverIsCommanded) {
  start();
  VehicleCommand command = flying();
  command.engaged = false;
  command.length_rate = command.elevation_rate = command.azimuth_rate = 1.0;
  command.yaw_rate = command.gimbal_pitch_rate = 1.0;
  command.action = VehicleAction::kTakeoff;
  const auto lines = run(1s, command);
  EXPECT_EQ(named(lines, "Pos").size(), 20U);
  for (const std::string& line : lines) {
    const auto parsed = readTextLine(line);
    ASSERT_TRUE(parsed);
    EXPECT_TRUE(parsed->name == "Pos" || parsed->name == "Yaw" || parsed->name == "Gimbal") << line;
    EXPECT_THAT(parsed->fields, Each(0.0)) << line;
  }
}

TEST_F(FotokiteDeviceTest, SendsRatesInTheDevicesUnitsAndSigns) {
  start();
  VehicleCommand command = flying();
  command.length_rate = 0.342;  // 120 counts/s of 2.85 mm
  command.elevation_rate = 0.1;
  command.azimuth_rate = -0.05;
  command.yaw_rate = 0.2;  // about +y, that is, against the device's z (down)
  command.gimbal_pitch_rate = 0.15;
  const auto lines = run(1s, command);
  EXPECT_EQ(named(lines, "Pos2").size(), 20U);
  EXPECT_EQ(named(lines, "Yaw").size(), 20U);
  EXPECT_EQ(named(lines, "Gimbal").size(), 2U);  // unchanged: every half second
  EXPECT_THAT(lastFields(lines, "Pos2"), ElementsAre(0.1, -0.05, 120.0));
  EXPECT_THAT(lastFields(lines, "Yaw"), ElementsAre(-0.2));
  EXPECT_THAT(lastFields(lines, "Gimbal"), ElementsAre(0.15, 0.0));
}

TEST_F(FotokiteDeviceTest, SendsAStopAtOnce) {
  start();
  VehicleCommand command = flying();
  command.elevation_rate = 0.1;
  while (run(kPeriod, command).empty()) continue;
  ASSERT_THAT(run(kPeriod, command), IsEmpty());  // just sent: not due
  command.elevation_rate = 0.0;
  EXPECT_THAT(lastFields(run(kPeriod, command), "Pos2"), ElementsAre(0.0, 0.0, 0.0));
  command.elevation_rate = 0.1;
  while (run(kPeriod, command).empty()) continue;
  EXPECT_THAT(lastFields(run(kPeriod), "Pos"), ElementsAre(0.0, 0.0, 0.0));
}

TEST_F(FotokiteDeviceTest, NeverSendsWhatIsNotFiniteOrBeyondTheLimits) {
  start();
  VehicleCommand command = flying();
  command.length_rate = 1e9;
  command.elevation_rate = std::numeric_limits<double>::quiet_NaN();
  command.azimuth_rate = -9.0;
  command.yaw_rate = -std::numeric_limits<double>::infinity();
  EXPECT_THAT(lastFields(run(100ms, command), "Pos2"), ElementsAre(0.0, -0.2, 10000.0));
  EXPECT_THAT(lastFields(run(100ms, command), "Yaw"), ElementsAre(0.0));
}

TEST_F(FotokiteDeviceTest, RepeatsTakeoffWhileAsked) {
  start();
  VehicleCommand command = flying();
  command.action = VehicleAction::kTakeoff;
  EXPECT_THAT(run(kPeriod, command), Contains("StartTakeoff"));
  EXPECT_EQ(named(run(1s, command), "StartTakeoff").size(), 20U);
  command.action = VehicleAction::kNone;
  EXPECT_THAT(run(1s, command), Not(Contains("StartTakeoff")));
}

TEST_F(FotokiteDeviceTest, MotorStopGoesOutAtOnceAlsoDisengagedAndDuringTheStart) {
  VehicleCommand command;
  command.action = VehicleAction::kMotorStop;
  EXPECT_THAT(run(kPeriod, command), ElementsAre("MotorStop", "stop"));
  run(30ms);
  EXPECT_THAT(run(kPeriod, command), Contains("MotorStop"));
  start();
  EXPECT_EQ(named(run(1s, command), "MotorStop").size(), 20U);
}

TEST_F(FotokiteDeviceTest, SwitchesTheTetherControllerOnChangeOnly) {
  start();
  VehicleCommand command = flying();
  EXPECT_THAT(run(kPeriod, command), AllOf(Contains("Pset 79,1"), Contains("Pcommit")));
  EXPECT_THAT(run(1s, command), Not(Contains(StartsWith("Pset"))));
  command.reel_controller = false;
  const auto lines = run(1s, command);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), "Pset 79,0"), 1);
  EXPECT_EQ(std::count(lines.begin(), lines.end(), "Pcommit"), 1);
}

TEST_F(FotokiteDeviceTest, StartsAgainWhenTheGroundStationLeavesRemoteControl) {
  start();
  const auto ground = [this](int mode) {
    receive("!GSStatus " + std::to_string(mode) + ",9.0,15.6,100\r\n");
  };
  ground(1);
  EXPECT_THAT(run(1900ms, flying()), Not(Contains("stop")));
  ground(10);  // came back by itself
  EXPECT_THAT(run(1900ms, flying()), Not(Contains("stop")));
  ground(0);
  ASSERT_THAT(run(2s, flying()), Not(Contains("stop")));
  run(20ms, flying());
  EXPECT_FALSE(device_.started());
  start();
  EXPECT_THAT(run(kPeriod, flying()), Contains("Pset 79,1"));  // told anew
}

TEST_F(FotokiteDeviceTest, StartsAgainAfterSilence) {
  start();
  EXPECT_THAT(run(4900ms), Not(Contains("stop")));
  receive("!Pos 0.5,0,0\r\n");
  EXPECT_THAT(run(4900ms), Not(Contains("stop")));
  EXPECT_THAT(run(300ms), Contains("stop"));
}

TEST_F(FotokiteDeviceTest, StartsAgainAfterReplugging) {
  start();
  receive("!Pos 0.5,0,0\r\n!Pos 0.6,");  // the cut line must not run into the next
  pty_.unplug();
  run(500ms);
  EXPECT_FALSE(frame_.link.connected);
  pty_.plug();
  auto lines = run(2s);
  ASSERT_GE(lines.size(), kStartSequence.size());
  lines.resize(kStartSequence.size());
  EXPECT_THAT(lines, ElementsAreArray(kStartSequence));
  receive("!Pos 0.7,0,0\r\n");
  EXPECT_TRUE(frame_.link.connected);
  EXPECT_EQ(frame_.link.reconnects, 1U);
  EXPECT_EQ(frame_.link.lines_bad, 0U);
  EXPECT_EQ(frame_.angles.sequence, 2U);
  EXPECT_NEAR(frame_.angles.value.theta, kPi / 2 - 0.7, 1e-12);
}

TEST_F(FotokiteDeviceTest, EndsWithZeroRatesAndStop) {
  start();
  VehicleCommand command = flying();
  command.elevation_rate = 0.1;
  run(100ms, command);
  device_.shutdown(now_);
  const auto lines = pty_.receiveLines();
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines.back(), "stop");
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_THAT(readTextLine(lines[i])->fields, Each(0.0)) << lines[i];
}

TEST_F(FotokiteDeviceTest, KeepsSamplesUntilTheNextAndNumbersThem) {
  EXPECT_FALSE(frame_.angles.valid);
  receive("!Pos 0.78,-0.52,1.20\r\n");
  const Time first = now_;
  EXPECT_TRUE(frame_.angles.valid);
  EXPECT_EQ(frame_.angles.sequence, 1U);
  now_ += 10ms;
  device_.read(now_, frame_);
  EXPECT_EQ(frame_.angles.sequence, 1U);
  EXPECT_EQ(frame_.angles.time, first);
  receive("!Pos 0.79,-0.52,1.20\n!Pos 0.80,-0.52,1.20\r\n");
  EXPECT_EQ(frame_.angles.sequence, 3U);
  EXPECT_EQ(frame_.angles.time, now_);
  EXPECT_NEAR(frame_.angles.value.theta, kPi / 2 - 0.80, 1e-12);
  EXPECT_EQ(frame_.link.lines_ok, 3U);
}

TEST_F(FotokiteDeviceTest, ADoubledLineIsTwoSamplesAndTwoRunTogetherAreNone) {
  const std::string line = "!Pos 0.78,-0.52,1.20";
  receive(line + "\r\n" + line + "\r\n");
  EXPECT_EQ(frame_.angles.sequence, 2U);
  receive(line + line + "\r\n");
  EXPECT_EQ(frame_.angles.sequence, 2U);
  EXPECT_EQ(frame_.link.lines_bad, 1U);
}

TEST_F(FotokiteDeviceTest, AnImpossibleValueInvalidatesAndAGarbledLineDoesNot) {
  receive("!Pos 0.78,-0.52,1.20\n!GSStatus 10,9.0,15.6,100\n!FlightStatus 2,1,8.1,0\n");
  receive("!Pos 0.7x,-0.52,1.20\n!Po\n");
  EXPECT_TRUE(frame_.angles.valid);
  receive("!Pos 78,-0.52,1.20\n!GSStatus 10,9.0,15.6,9e9\n!FlightStatus 999,1,8.1,0\n");
  EXPECT_FALSE(frame_.angles.valid);
  EXPECT_FALSE(frame_.reel.valid);
  EXPECT_FALSE(frame_.vehicle.valid);
  EXPECT_EQ(frame_.angles.sequence, 1U);
  EXPECT_NEAR(frame_.angles.value.altitude.value(), 1.20, 1e-12);  // the last good one
  EXPECT_EQ(frame_.link.lines_bad, 5U);
  EXPECT_EQ(device_.lines()[fotokite::LineError::kOutOfRange], 3U);
  EXPECT_EQ(device_.lines()[fotokite::LineError::kNotANumber], 1U);
  EXPECT_EQ(device_.lines()[fotokite::LineError::kUnknownHeader], 1U);
  receive("!Pos 0.78,-0.52,1.20\n");
  EXPECT_TRUE(frame_.angles.valid);
}

TEST_F(FotokiteDeviceTest, SurvivesAnyBytesOneAtATimeAndThenReadsOn) {
  std::mt19937 random(11);
  for (int i = 0; i < 20000; ++i) {
    pty_.send(std::string(1, static_cast<char>(random() % 256)));
    if (i % 7 == 0) device_.read(now_, frame_);
  }
  receive("\n!Pos 0.78,-0.52,1.20\r\n");
  device_.read(now_, frame_);
  EXPECT_TRUE(frame_.angles.valid);
  EXPECT_NEAR(frame_.angles.value.theta, kPi / 2 - 0.78, 1e-12);
  EXPECT_EQ(frame_.link.lines_ok, 1U);
  EXPECT_EQ(frame_.link.bytes_in, 20000U + 23U);
}

// Oracle: the device's own axes, p = L (cos theta cos a, sin theta, -cos theta sin a).
TEST_F(FotokiteDeviceTest, TetherAnglesPointWhereTheDeviceSays) {
  for (const double e : {0.0, 0.3, 0.78, 1.57, 2.0}) {
    for (const double a : {-3.1, -1.6, -0.5, 0.0, 0.5, 1.5, 3.1}) {
      std::array<char, 64> line{};
      std::snprintf(line.data(), line.size(), "!Pos %.2f,%.2f,0\n", e, a);
      receive(line.data());
      const TetherAngles& got = frame_.angles.value;
      const double theta = kPi / 2 - e;
      const Eigen::Vector3d want(std::cos(theta) * std::cos(a), std::sin(theta),
                                 -std::cos(theta) * std::sin(a));
      EXPECT_TRUE(toCartesian({.L = 1.0, .theta = got.theta, .phi = got.phi}).isApprox(want, 1e-12))
          << e << " " << a;
    }
  }
}

TEST_F(FotokiteDeviceTest, MapsFlightModesAndPassesFlagsOn) {
  const std::pair<int, VehiclePhase> cases[] = {
      {1, VehiclePhase::kIdle},    {2, VehiclePhase::kFlying},   {3, VehiclePhase::kFlying},
      {5, VehiclePhase::kUnknown}, {48, VehiclePhase::kLanding}, {49, VehiclePhase::kStopped},
      {50, VehiclePhase::kFault},  {52, VehiclePhase::kStopped}, {53, VehiclePhase::kFault},
      {54, VehiclePhase::kFault},  {55, VehiclePhase::kFault},   {99, VehiclePhase::kUnknown}};
  for (const auto& [mode, phase] : cases) {
    receive("!FlightStatus " + std::to_string(mode) + ",63.2,8.10,4352\r\n");
    EXPECT_EQ(frame_.vehicle.value.phase, phase) << mode;
    EXPECT_EQ(frame_.vehicle.value.flight_mode, mode);
  }
  EXPECT_EQ(frame_.vehicle.value.flags, fotokite::kEmergencyLandFlag | fotokite::kFlyawayCandidate);
  EXPECT_DOUBLE_EQ(frame_.vehicle.value.backup_battery_voltage, 8.10);
}

TEST_F(FotokiteDeviceTest, ReadsTheReel) {
  receive("!GSStatus 10,9.0,15.62,1000\r\n");
  EXPECT_NEAR(frame_.reel.value.length, 2.85, 1e-12);
  EXPECT_EQ(frame_.reel.value.counts, 1000.0);
  EXPECT_EQ(frame_.ground.value.mode, 10);
  EXPECT_DOUBLE_EQ(frame_.ground.value.battery_voltage, 15.62);
  receive("!GSStatus 10,9.0,15.62,-20\r\n");
  EXPECT_EQ(frame_.reel.value.length, 0.0);  // never negative
  EXPECT_EQ(frame_.reel.value.counts, -20.0);
}

std::string quaternionLine(const char* header, const Eigen::Quaterniond& q) {
  std::array<char, 96> line{};
  std::snprintf(line.data(), line.size(), "%s %.9f,%.9f,%.9f,%.9f\n", header, q.w(), q.x(), q.y(),
                q.z());
  return line.data();
}

// A device with everything adjustable set to something else than its default.
class CalibratedDeviceTest : public FotokiteDeviceTest,
                             public ::testing::WithParamInterface<VerticalAxis> {
 protected:
  static constexpr double kAzimuthOffset = 0.4;

  CalibratedDeviceTest() : FotokiteDeviceTest(config()) {}

  static FotokiteConfig config() {
    FotokiteConfig config;
    config.length_scale_m_per_count = 0.00406;
    config.length_offset_m = 0.5;
    config.invert_length = true;
    config.azimuth_offset_rad = kAzimuthOffset;
    config.attitude_z = GetParam();
    config.telemetry_rate_hz = 20.0;
    config.command_rate_hz = 50.0;
    return config;
  }

  // What the quaternion means, axis by axis: z up is forward-left-up, z down is forward-right-down.
  static bool up() { return GetParam() == VerticalAxis::kUp; }
  static Eigen::Vector3d toWorld(const Eigen::Vector3d& v_I) {
    const Eigen::Vector3d v = up() ? Eigen::Vector3d(v_I.x(), v_I.z(), -v_I.y())
                                   : Eigen::Vector3d(v_I.x(), -v_I.z(), v_I.y());
    return Eigen::AngleAxisd(kAzimuthOffset, Eigen::Vector3d::UnitY()) * v;
  }
};

TEST_P(CalibratedDeviceTest, AttitudeTurnsEachBodyAxisAsTheDeviceDoes) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const Eigen::Vector3d up_V(0, 0, up() ? 1 : -1);
  const Eigen::Vector3d right_V(0, up() ? -1 : 1, 0);
  for (int i = 0; i < 100; ++i) {
    const auto q =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized();
    receive(quaternionLine("!Attitude", q));
    const Eigen::Quaterniond R_WB = frame_.attitude.value.R_WB;
    EXPECT_NEAR(R_WB.norm(), 1.0, 1e-12);
    EXPECT_TRUE(
        (R_WB * Eigen::Vector3d::UnitX()).isApprox(toWorld(q * Eigen::Vector3d::UnitX()), 1e-7));
    EXPECT_TRUE((R_WB * Eigen::Vector3d::UnitY()).isApprox(toWorld(q * up_V), 1e-7));
    EXPECT_TRUE((R_WB * Eigen::Vector3d::UnitZ()).isApprox(toWorld(q * right_V), 1e-7));
  }
}

TEST_P(CalibratedDeviceTest, LevelAtInitializationIsHeadingAlongTheDevicesZeroAzimuth) {
  receive(quaternionLine("!Attitude", Eigen::Quaterniond::Identity()) +
          "!Pos 1.570796326794896,0,0\n");
  const Eigen::Vector3d nose = frame_.attitude.value.R_WB * Eigen::Vector3d::UnitX();
  const TetherAngles& angles = frame_.angles.value;
  EXPECT_TRUE(
      nose.isApprox(toCartesian({.L = 1.0, .theta = angles.theta, .phi = angles.phi}), 1e-12));
  EXPECT_NEAR((frame_.attitude.value.R_WB * Eigen::Vector3d::UnitY()).y(), 1.0, 1e-12);  // level
}

TEST_P(CalibratedDeviceTest, GimbalPitchIsUpPositiveAtAnyHeading) {
  const double nose_up = up() ? -1.0 : 1.0;  // about the device's y
  for (const double pitch : {-1.4, -0.3, 0.0, 0.5}) {
    for (const double heading : {-2.0, 0.0, 1.0}) {
      const Eigen::Quaterniond q(Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(nose_up * pitch, Eigen::Vector3d::UnitY()));
      receive(quaternionLine("!Gimbal", q));
      EXPECT_NEAR(frame_.gimbal.value.pitch, pitch, 1e-7);
    }
  }
}

TEST_P(CalibratedDeviceTest, YawAndGimbalRatesMatchTheQuaternionsAxes) {
  start();
  VehicleCommand command = flying();
  command.yaw_rate = 0.2;
  command.gimbal_pitch_rate = 0.1;
  const auto lines = run(100ms, command);
  EXPECT_THAT(lastFields(lines, "Yaw"), ElementsAre(up() ? 0.2 : -0.2));
  EXPECT_THAT(lastFields(lines, "Gimbal"), ElementsAre(up() ? -0.1 : 0.1, 0.0));
}

TEST_P(CalibratedDeviceTest, LengthCalibrationHoldsBothWays) {
  receive("!GSStatus 10,9.0,15.62,-1000\r\n");
  EXPECT_NEAR(frame_.reel.value.length, 4.06 + 0.5, 1e-12);
  start();
  VehicleCommand command = flying();
  command.length_rate = 0.406;
  const auto lines = run(1s, command);
  EXPECT_EQ(named(lines, "Pos2").size(), 50U);
  EXPECT_THAT(lastFields(lines, "Pos2"), ElementsAre(0.0, 0.0, -100.0));
}

TEST_P(CalibratedDeviceTest, AsksForTheConfiguredTelemetryRate) {
  EXPECT_THAT(start(), AllOf(Contains("Pset 117,20.0"), Not(Contains("Pset 117,10.0"))));
}

INSTANTIATE_TEST_SUITE_P(Axes, CalibratedDeviceTest,
                         ::testing::Values(VerticalAxis::kDown, VerticalAxis::kUp),
                         [](const auto& axis) {
                           return axis.param == VerticalAxis::kUp ? "ZUp" : "ZDown";
                         });

}  // namespace
}  // namespace tautline
