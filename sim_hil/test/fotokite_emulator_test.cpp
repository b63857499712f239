#include "sim_hil/fotokite_emulator.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "sim_hil/test/flight_rig.h"
#include "sim_hil/test/wire_client.h"

namespace tautline::sim {
namespace {

constexpr double kHalfPi = std::numbers::pi / 2.0;

class Emulator : public ::testing::Test {
 protected:
  void build(const SimConfig& config, const Scene& scene = emptyRoom()) {
    plant_ = std::make_unique<Plant>(config, scene, 1);
    device_ = std::make_unique<FotokiteEmulator>(config.fotokite, *plant_);
  }
  void SetUp() override { build(calmConfig()); }

  void send(const std::string& text) {
    device_->receive({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / 0.002)); ++i) {
      plant_->step();
      device_->advance();
      std::array<std::uint8_t, 512> out;
      const std::size_t n = device_->transmit(out);
      client_.take(std::string(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(n)));
    }
  }
  /// The same command again and again, as a client must.
  void keep(const std::string& command, double seconds) {
    for (double t = 0.0; t < seconds - 1e-9; t += 0.1) {
      send(command + "\n");
      run(0.1);
    }
  }
  void start() {
    send(WireClient::startSequence());
    run(0.2);
  }
  void takeOff() {
    start();
    send("StartTakeoff\n");
    keep("Pos 0,0,0", 9.0);
    ASSERT_EQ(plant_->vehicle().phase(), FlightPhase::kFlying);
  }
  const Truth& truth() const { return plant_->truth(); }

  std::unique_ptr<Plant> plant_;
  std::unique_ptr<FotokiteEmulator> device_;
  WireClient client_;
};

TEST_F(Emulator, IsSilentUntilSubscribedTo) {
  run(3.0);
  EXPECT_FALSE(client_.has("!GSStatus"));
  send("Get_GroundStatus 0\n");
  run(3.0);
  EXPECT_TRUE(client_.has("!GSStatus"));
  EXPECT_EQ(client_.text("!GSStatus", 0), "1");  // menu
  EXPECT_FALSE(client_.has("!Pos"));
}

TEST_F(Emulator, StartSequenceBringsTelemetryOfEveryKind) {
  start();
  run(1.0);
  EXPECT_EQ(client_.text("!GSStatus", 0), "10");
  EXPECT_EQ(client_.fieldCount("!GSStatus"), 4U);
  EXPECT_EQ(client_.fieldCount("!Attitude"), 4U);
  EXPECT_EQ(client_.fieldCount("!Gimbal"), 4U);
  EXPECT_EQ(client_.fieldCount("!Pos"), 3U);
  EXPECT_EQ(client_.fieldCount("!FlightStatus"), 4U);
  EXPECT_EQ(client_.text("!FlightStatus", 0), "1");
  EXPECT_EQ(client_.text("!FlightStatus", 3), "0");
  EXPECT_EQ(client_.badLines(), 0);
  EXPECT_EQ(device_->refusedLines(), 0U);
  // Counts since power-on with all tether in.
  EXPECT_NEAR(client_.number("!GSStatus", 3), truth().length / 0.00285, 1.0);
}

TEST_F(Emulator, TelemetryRates) {
  send("RemoteControl start\nGet_Pos 0\nGet_FlightStatus 0\n");
  run(10.0);
  EXPECT_NEAR(client_.count("!Pos"), 10, 1);  // default 1 Hz
  send("Pset 117,25\n");
  run(2.0);
  client_.resetCounts();
  run(4.0);
  EXPECT_NEAR(client_.count("!Pos"), 4, 1);  // not before Pcommit
  send("Pcommit\n");
  run(0.1);
  client_.resetCounts();
  run(10.0);
  EXPECT_NEAR(client_.count("!Pos"), 250, 2);
  EXPECT_NEAR(client_.count("!FlightStatus"), 100, 2);
  send("Pset 117,1000\nPcommit\n");
  run(0.1);
  client_.resetCounts();
  run(5.0);
  EXPECT_NEAR(client_.count("!Pos"), 500, 5);  // at most 100 Hz
}

TEST_F(Emulator, ForcedRate) {
  SimConfig config = calmConfig();
  config.fotokite.forced_rate = 2.0;
  build(config);
  start();
  client_.resetCounts();
  run(10.0);
  EXPECT_NEAR(client_.count("!Pos"), 20, 1);
}

TEST_F(Emulator, AnglesAreInHundredthsAndInTheDevicesConvention) {
  takeOff();
  keep("Pos 0,0.2,0", 2.0);
  keep("Pos 0,0,0", 4.0);
  const std::string elevation = client_.text("!Pos", 0);
  EXPECT_EQ(elevation.size() - elevation.find('.'), 3U) << elevation;
  EXPECT_NEAR(client_.number("!Pos", 0), kHalfPi - truth().tangent_elevation, 0.03);
  EXPECT_NEAR(client_.number("!Pos", 1), truth().tangent_azimuth - kHalfPi, 0.03);
  EXPECT_NEAR(truth().tangent_azimuth, 0.4, 0.03);
  EXPECT_NEAR(client_.number("!Pos", 2), truth().p_WD.y() + 0.2, 0.5);
}

TEST_F(Emulator, AttitudeLeansAgainstThePullOfTheTether) {
  takeOff();
  keep("Pos -0.2,0,0", 2.0);
  keep("Pos 0,0,0", 4.0);
  // The tether points to +z = y of the device's frame. Body z (down) in that frame:
  const double w = client_.number("!Attitude", 0);
  const double x = client_.number("!Attitude", 1);
  const double y = client_.number("!Attitude", 2);
  const double z = client_.number("!Attitude", 3);
  EXPECT_NEAR(w * w + x * x + y * y + z * z, 1.0, 1e-3);
  const double down_y = 2.0 * (y * z - w * x);
  const double down_z = 1.0 - 2.0 * (x * x + y * y);
  // Thrust, -z of the body, balances weight and tether.
  const double theta = truth().tangent_elevation;
  const double T = truth().tension;
  const double lean = std::atan2(T * std::cos(theta), 0.618 * 9.81 + T * std::sin(theta));
  EXPECT_NEAR(std::atan2(-down_y, down_z), lean, 0.02);
}

TEST_F(Emulator, ElevationAndAzimuthCommands) {
  takeOff();
  const auto moved = [&](const std::string& command) {
    keep("Pos 0,0,0", 2.0);
    const double e = truth().setpoint_elevation;
    const double a = truth().setpoint_azimuth;
    keep(command, 1.0);
    return std::pair(truth().setpoint_elevation - e, wrapped(truth().setpoint_azimuth - a));
  };
  const auto near = [](std::pair<double, double> got, double e, double a) {
    EXPECT_NEAR(got.first, e, 0.002);
    EXPECT_NEAR(got.second, a, 0.002);
  };
  near(moved("Pos 0.1,-0.15,0"), 0.1, -0.15);
  near(moved("Pos2 -0.1,0.15,0"), -0.1, 0.15);
  near(moved("PosV 0.05"), 0.05, 0.0);
  near(moved("PosH -0.05"), 0.0, -0.05);
  near(moved("Pos 9,-9,0"), 0.25, -0.2);  // cut to the device's limits
  near(moved("Pos -9,9,0"), -0.25, 0.2);
}

TEST_F(Emulator, LengthChangesAreExecutedAndLengthRatesRun) {
  takeOff();
  const auto counts = [&] { return static_cast<double>(plant_->reel().counts()); };
  const double start = counts();
  send("Pos 0,0,100\n");
  run(0.4);
  keep("PosV 0", 3.0);  // does not touch the reel
  EXPECT_NEAR(counts() - start, 100.0, 2.0);
  send("PosL -100\n");
  run(0.4);
  keep("PosV 0", 3.0);
  EXPECT_NEAR(counts() - start, 0.0, 2.0);
  keep("Pos2 0,0,100", 2.0);
  EXPECT_NEAR(counts() - start, 200.0, 20.0);
  keep("Pos 0,0,0", 1.0);
  const double held = counts();
  keep("Pos2 0,0,-160", 2.0);  // the middle of the dead zone
  EXPECT_NEAR(counts(), held, 1.0);
  EXPECT_NEAR(truth().length, (counts() + 0.5) * 0.00285, 0.003);
}

TEST_F(Emulator, Parameter79LocksTheReel) {
  takeOff();
  send("Pset 79,0\nPcommit\n");
  const auto held = plant_->reel().counts();
  keep("Pos2 0,0,200", 2.0);
  EXPECT_EQ(plant_->reel().counts(), held);
  send("Pset 79,1\nPcommit\n");
  keep("Pos2 0,0,200", 2.0);
  EXPECT_GT(plant_->reel().counts(), held + 300);
}

TEST_F(Emulator, YawAndGimbal) {
  takeOff();
  keep("Yaw 0.3", 1.0);
  keep("Yaw 0", 0.2);
  EXPECT_NEAR(truth().yaw, -0.3, 0.01);  // about the device's z, which points down
  keep("Gimbal -0.2,0", 1.0);
  keep("GimbalPitch 0", 0.3);
  EXPECT_NEAR(plant_->vehicle().gimbalPitch(), -0.2, 0.01);
  keep("GimbalRoll 9", 1.0);
  keep("GimbalRoll 0", 0.3);
  EXPECT_NEAR(plant_->vehicle().gimbalRoll(), 0.3, 0.01);
  // View direction, x of the gimbal, in the device's frame (z down).
  const double w = client_.number("!Gimbal", 0);
  const double x = client_.number("!Gimbal", 1);
  const double y = client_.number("!Gimbal", 2);
  const double z = client_.number("!Gimbal", 3);
  EXPECT_NEAR(2.0 * (x * z - w * y), std::sin(0.2), 0.01);  // looks down
  EXPECT_NEAR(std::atan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z)), 0.3, 0.01);
}

TEST_F(Emulator, NoFlightWithoutRemoteControl) {
  send("StartTakeoff\nPos 0.1,0,0\n");
  run(3.0);
  EXPECT_FALSE(truth().motors_on);
  EXPECT_EQ(device_->refusedLines(), 2U);
}

TEST_F(Emulator, GarbageIsRefusedAndHarmless) {
  takeOff();
  const std::uint32_t before = device_->refusedLines();
  for (const char* line :
       {"Pos", "Pos 1,2", "Pos 1,2,3,4", "Pos a,b,c", "Pos nan,0,0", "Pos inf,0,0", "pos 1,2,3",
        "Pos2", "Hello", "Pset 117", "Yaw", "RemoteControl stop", "\x01\x02\xff", "Pos 1e999,0,0",
        "Pos ,,", "Pos 1,2,"}) {
    send(std::string(line) + "\n");
  }
  send(std::string(5000, 'x') + "\n");  // longer than any line: dropped
  EXPECT_EQ(device_->refusedLines() - before, 16U);
  const double e = truth().setpoint_elevation;
  keep("Pos 0,0,0", 1.0);
  EXPECT_DOUBLE_EQ(truth().setpoint_elevation, e);
  send("  Pos   +0.1 , 0.0 ,0 \r");  // blanks, plus sign, carriage return
  run(0.2);
  EXPECT_GT(truth().setpoint_elevation, e + 0.015);
}

TEST_F(Emulator, ALineMayArriveInPieces) {
  takeOff();
  const double e = truth().setpoint_elevation;
  for (const char c : std::string("Pos 0.2,0,0\n")) {
    send(std::string(1, c));
    run(0.01);
  }
  run(0.3);
  EXPECT_NEAR(truth().setpoint_elevation - e, 0.06, 0.005);
}

TEST_F(Emulator, SilenceHoldsThenLands) {
  takeOff();
  keep("Pos2 0.1,0.1,0", 0.5);
  run(0.35);
  EXPECT_EQ(device_->flags() & fotokite::kNoSyncCommands, 0);
  run(0.2);
  EXPECT_NE(device_->flags() & fotokite::kNoSyncCommands, 0);
  const double e = truth().setpoint_elevation;
  const double a = truth().setpoint_azimuth;
  run(3.0);
  EXPECT_DOUBLE_EQ(truth().setpoint_elevation, e);
  EXPECT_DOUBLE_EQ(truth().setpoint_azimuth, a);
  keep("Pos 0,0,0", 0.2);
  EXPECT_EQ(device_->flags() & fotokite::kNoSyncCommands, 0);
  run(10.5);
  EXPECT_EQ(device_->flightMode(), fotokite::FlightMode::kEmergencyLand);
  EXPECT_NE(device_->flags() & fotokite::kEmergencyLandFlag, 0);
  run(40.0);
  EXPECT_TRUE(truth().on_ground);
  EXPECT_FALSE(truth().motors_on);
  EXPECT_FALSE(truth().crashed);
  EXPECT_EQ(device_->flightMode(), fotokite::FlightMode::kIdle);
}

TEST_F(Emulator, MotorStopOnTheGroundAndInTheAir) {
  takeOff();
  for (int i = 0; i < 200 && !truth().on_ground; ++i) keep("Pos -0.2,0,0", 0.1);
  keep("Pos 0,0,0", 1.0);
  send("MotorStop\n");
  run(0.1);
  EXPECT_EQ(device_->flightMode(), fotokite::FlightMode::kMotorStopRestart);
  run(3.0);
  EXPECT_EQ(device_->flightMode(), fotokite::FlightMode::kIdle);
  EXPECT_FALSE(truth().crashed);
  // It can fly again; then the motors stop in the air.
  send("StartTakeoff\n");
  keep("Pos 0,0,0", 8.0);
  EXPECT_EQ(device_->flightMode(), fotokite::FlightMode::kAngle);
  send("MotorStop\n");
  run(0.05);
  EXPECT_EQ(device_->flightMode(), fotokite::FlightMode::kMotorStopDisable);
  run(2.0);
  EXPECT_TRUE(truth().crashed);
  EXPECT_EQ(device_->flightMode(), fotokite::FlightMode::kHardKill);
  EXPECT_NE(device_->flags() & fotokite::kHardKillFlag, 0);
  send("StartTakeoff\n");
  keep("Pos 0,0,0", 3.0);
  EXPECT_FALSE(truth().motors_on);
}

TEST_F(Emulator, SlackTetherIsFlagged) {
  takeOff();
  EXPECT_EQ(device_->flags() & fotokite::kNoTetherDetected, 0);
  bool seen = false;
  for (int i = 0; i < 40; ++i) {  // pays out faster than the vehicle flies
    keep("Pos2 0,0,2000", 0.1);
    seen = seen || (device_->flags() & fotokite::kNoTetherDetected) != 0;
  }
  EXPECT_TRUE(seen);
}

TEST_F(Emulator, LowLaunchAngleIsFlaggedWhileItIsLow) {
  SimConfig config = calmConfig();
  config.fotokite.low_launch_angle = 0.3;
  build(config);
  start();
  EXPECT_EQ(device_->flags(), 0);
  send("StartTakeoff\n");
  run(0.1);
  EXPECT_NE(device_->flags() & fotokite::kLowLaunchAngle, 0);
  keep("Pos 0,0,0", 8.0);
  EXPECT_EQ(device_->flags() & fotokite::kLowLaunchAngle, 0);
}

TEST_F(Emulator, BatteryRunsDownFlagsAndLands) {
  SimConfig config = calmConfig();
  config.vehicle.battery_life = 60.0;
  build(config);
  takeOff();
  EXPECT_EQ(device_->flags() & fotokite::kLowBattery, 0);
  double last = client_.number("!GSStatus", 2);
  bool low = false;
  bool critical = false;
  bool landing = false;
  for (int i = 0; i < 90; ++i) {
    keep("Pos 0,0,0", 1.0);
    if (truth().motors_on) {
      EXPECT_LE(client_.number("!GSStatus", 2), last + 1e-9);
    }
    last = client_.number("!GSStatus", 2);
    low = low || (device_->flags() & fotokite::kLowBattery) != 0;
    critical = critical || (device_->flags() & fotokite::kCriticalBattery) != 0;
    landing = landing || device_->flightMode() == fotokite::FlightMode::kEmergencyLand;
  }
  EXPECT_TRUE(low);
  EXPECT_TRUE(critical);
  EXPECT_TRUE(landing);
  EXPECT_TRUE(truth().on_ground);
  EXPECT_FALSE(truth().crashed);
  EXPECT_EQ(device_->flightMode(), fotokite::FlightMode::kBatteryTooLow);
  send("StartTakeoff\n");
  keep("Pos 0,0,0", 2.0);
  EXPECT_FALSE(truth().motors_on);
}

TEST_F(Emulator, StopEndsRemoteControlAndTelemetry) {
  start();
  send("stop\n");
  run(0.5);
  client_.resetCounts();
  run(3.0);
  EXPECT_EQ(client_.count("!Pos"), 0);
  EXPECT_EQ(device_->groundMode(), fotokite::GroundMode::kMenu);
}

TEST_F(Emulator, AClientThatDoesNotReadLosesWholeLinesOnly) {
  start();
  send("Pset 117,100\nPcommit\n");
  for (int i = 0; i < 10000; ++i) {
    plant_->step();
    device_->advance();
  }
  run(1.0);
  EXPECT_EQ(client_.badLines(), 0);
}

}  // namespace
}  // namespace tautline::sim
