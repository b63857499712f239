#include "control/command_gate.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace tautline {
namespace {

constexpr Duration kStep = std::chrono::milliseconds(10);
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

const VehicleLimits kLimits;  // 0.6 m/s, 0.25, 0.2, 0.4, 0.3 rad/s
const CommandGateConfig kSlow;
const CommandGateConfig kNoSlope{.length_accel_mps2 = 1e3,
                                 .elevation_accel_radps2 = 1e3,
                                 .azimuth_accel_radps2 = 1e3,
                                 .yaw_accel_radps2 = 1e3,
                                 .gimbal_accel_radps2 = 1e3};

VehicleCommand rates(double length, double elevation, double azimuth, double yaw = 0.0,
                     double gimbal = 0.0) {
  VehicleCommand c;
  c.engaged = true;
  c.length_rate = length;
  c.elevation_rate = elevation;
  c.azimuth_rate = azimuth;
  c.yaw_rate = yaw;
  c.gimbal_pitch_rate = gimbal;
  return c;
}

bool atRest(const VehicleCommand& c) {
  return c.length_rate == 0.0 && c.elevation_rate == 0.0 && c.azimuth_rate == 0.0 &&
         c.yaw_rate == 0.0 && c.gimbal_pitch_rate == 0.0;
}

TEST(CommandGate, LetsAGoodCommandThroughUnchanged) {
  CommandGate gate(kNoSlope, kLimits);
  VehicleCommand in = rates(0.3, -0.1, 0.05, 0.2, -0.1);
  in.action = VehicleAction::kTakeoff;
  in.reel_controller = true;
  const GatedCommand out = gate.apply(kStep, in);
  EXPECT_EQ(out.command.length_rate, 0.3);
  EXPECT_EQ(out.command.elevation_rate, -0.1);
  EXPECT_EQ(out.command.azimuth_rate, 0.05);
  EXPECT_EQ(out.command.yaw_rate, 0.2);
  EXPECT_EQ(out.command.gimbal_pitch_rate, -0.1);
  EXPECT_EQ(out.command.action, VehicleAction::kTakeoff);
  EXPECT_TRUE(out.command.reel_controller);
  EXPECT_FALSE(out.clamped || out.slewed || out.not_finite);
}

TEST(CommandGate, ClampKeepsTheDirection) {
  CommandGate gate(kNoSlope, kLimits);
  const GatedCommand out = gate.apply(kStep, rates(0.6, 0.5, -1.0));
  EXPECT_TRUE(out.clamped);
  EXPECT_NEAR(out.command.azimuth_rate, -0.2, 1e-15);  // five times over: all by a fifth
  EXPECT_NEAR(out.command.length_rate, 0.12, 1e-15);
  EXPECT_NEAR(out.command.elevation_rate, 0.1, 1e-15);
}

TEST(CommandGate, YawAndGimbalAreBoundedByThemselves) {
  CommandGate gate(kNoSlope, kLimits);
  const GatedCommand out = gate.apply(kStep, rates(0.3, 0.0, 0.0, 9.0, -9.0));
  EXPECT_TRUE(out.clamped);
  EXPECT_EQ(out.command.yaw_rate, 0.4);
  EXPECT_EQ(out.command.gimbal_pitch_rate, -0.3);
  EXPECT_EQ(out.command.length_rate, 0.3);
}

TEST(CommandGate, RateLimitGoesStraightToTheNewCommandAndArrives) {
  CommandGate gate(kSlow, kLimits);
  const VehicleCommand want = rates(0.6, 0.1, -0.1);
  double last = 0.0;
  int cycles = 0;
  for (; cycles < 1000; ++cycles) {
    const GatedCommand out = gate.apply(kStep, want);
    EXPECT_NEAR(out.command.elevation_rate, out.command.length_rate / 6.0, 1e-12);
    EXPECT_NEAR(out.command.azimuth_rate, -out.command.length_rate / 6.0, 1e-12);
    EXPECT_LE(out.command.length_rate - last, kSlow.length_accel_mps2 * 0.01 + 1e-12);
    last = out.command.length_rate;
    if (!out.slewed) break;
  }
  EXPECT_EQ(last, 0.6);
  EXPECT_NEAR(cycles, 40, 1);  // 0.6 m/s at 1.5 m/s^2
}

TEST(CommandGate, FirstCycleAndLateCyclesAreNoLicenceToJump) {
  CommandGate gate(kSlow, kLimits);
  EXPECT_TRUE(atRest(gate.apply(Duration(0), rates(0.6, 0.0, 0.0)).command));
  EXPECT_TRUE(atRest(gate.apply(-kStep, rates(0.6, 0.0, 0.0)).command));
  const GatedCommand late = gate.apply(std::chrono::seconds(5), rates(0.6, 0.0, 0.0));
  EXPECT_NEAR(late.command.length_rate, 0.15, 1e-12);
}

TEST(CommandGate, NotFiniteIsZeroAtOnceAndFlagged) {
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int field = 0; field < 5; ++field) {
      CommandGate gate(kSlow, kLimits);
      for (int i = 0; i < 100; ++i) (void)gate.apply(kStep, rates(0.5, 0.1, 0.1, 0.3, 0.2));
      VehicleCommand in = rates(0.5, 0.1, 0.1, 0.3, 0.2);
      (field == 0   ? in.length_rate
       : field == 1 ? in.elevation_rate
       : field == 2 ? in.azimuth_rate
       : field == 3 ? in.yaw_rate
                    : in.gimbal_pitch_rate) = bad;
      const GatedCommand out = gate.apply(kStep, in);
      EXPECT_TRUE(out.not_finite) << field;
      EXPECT_TRUE(atRest(out.command)) << field;
      // And it starts again from rest.
      const GatedCommand next = gate.apply(kStep, rates(0.5, 0.0, 0.0));
      EXPECT_FALSE(next.not_finite);
      EXPECT_NEAR(next.command.length_rate, 0.015, 1e-12);
    }
  }
}

TEST(CommandGate, NotEngagedIsRestAtOnce) {
  CommandGate gate(kSlow, kLimits);
  for (int i = 0; i < 100; ++i) (void)gate.apply(kStep, rates(0.5, 0.1, 0.1));
  VehicleCommand in = rates(0.5, 0.1, 0.1);
  in.engaged = false;
  in.action = VehicleAction::kMotorStop;
  const GatedCommand out = gate.apply(kStep, in);
  EXPECT_TRUE(atRest(out.command));
  EXPECT_EQ(out.command.action, VehicleAction::kMotorStop);
}

TEST(CommandGate, NothingItLetsThroughIsEverBeyondALimitOrASlope) {
  std::mt19937 random(5);
  std::normal_distribution<double> wild(0.0, 1.0);
  CommandGate gate(kSlow, kLimits);
  VehicleCommand last;
  for (int i = 0; i < 20000; ++i) {
    const VehicleCommand c = gate.apply(kStep, rates(wild(random), wild(random), wild(random),
                                                     wild(random), wild(random)))
                                 .command;
    constexpr double kRounding = 1e-12;
    ASSERT_LE(std::abs(c.length_rate), kLimits.length_rate_mps + kRounding);
    ASSERT_LE(std::abs(c.elevation_rate), kLimits.elevation_rate_radps + kRounding);
    ASSERT_LE(std::abs(c.azimuth_rate), kLimits.azimuth_rate_radps + kRounding);
    ASSERT_LE(std::abs(c.yaw_rate), kLimits.yaw_rate_radps);
    ASSERT_LE(std::abs(c.gimbal_pitch_rate), kLimits.gimbal_pitch_rate_radps);
    ASSERT_LE(std::abs(c.length_rate - last.length_rate), 0.015 + kRounding);
    ASSERT_LE(std::abs(c.elevation_rate - last.elevation_rate), 0.01 + kRounding);
    ASSERT_LE(std::abs(c.azimuth_rate - last.azimuth_rate), 0.01 + kRounding);
    ASSERT_LE(std::abs(c.yaw_rate - last.yaw_rate), 0.02 + kRounding);
    last = c;
  }
}

}  // namespace
}  // namespace tautline
