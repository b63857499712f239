#pragma once

/// @file
/// A short flight of the real device and port against the emulated machine on a CAN bus, whatever
/// carries it.

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include <gtest/gtest.h>

#include "drivers/can_socket.h"
#include "drivers/tautline_device.h"
#include "sim_hil/can_link.h"
#include "sim_hil/simulator.h"

namespace tautline::bench {

inline sim::SimConfig calmBus() {
  sim::SimConfig config;
  config.device = sim::SimDevice::kTautlineCan;
  config.wind.gust = 0.0;
  return config;
}

class BusFlight {
 public:
  static constexpr Duration kPeriod = std::chrono::milliseconds(10);

  BusFlight(CanSocket& socket, sim::CanLink& link)
      : link_(link), device_(socket, TautlineConfig{}, "tautline-can") {
    Scene scene;
    scene.floor = -0.3;
    simulator_ = std::make_unique<sim::Simulator>(calmBus(), scene, 1);
  }

  /// `seconds` of virtual time with one command, on no clock but its own.
  void run(double seconds, const VehicleCommand& command) {
    for (const Time end = now_ + fromSeconds(seconds); now_ < end;) {
      now_ += kPeriod;
      for (std::size_t n = link_.read(buffer_); n > 0; n = link_.read(buffer_))
        simulator_->receive(std::span(buffer_).first(n));
      simulator_->advanceTo(Time{} + (now_ - kStart));
      std::size_t left = simulator_->transmit(buffer_);
      const std::size_t taken = link_.write(std::span(buffer_).first(left));
      EXPECT_EQ(taken, left);
      device_.read(now_, frame_);
      device_.write(now_, command);
    }
  }

  /// Up, out, round and silent: what a device on the bus has to do.
  void fly() {
    VehicleCommand command;
    run(1.0, command);
    ASSERT_EQ(frame_.link.fault, LinkFault::kNone);
    ASSERT_TRUE(frame_.reel.valid && frame_.angles.valid && frame_.attitude.valid);
    ASSERT_EQ(frame_.vehicle.value.phase, VehiclePhase::kIdle);
    command.engaged = true;
    command.action = VehicleAction::kTakeoff;
    run(0.01, command);
    command.action = VehicleAction::kNone;
    run(8.0, command);
    ASSERT_EQ(frame_.vehicle.value.phase, VehiclePhase::kFlying);
    const double length = simulator_->truth().length;
    command.reel_controller = true;
    command.length_rate = 0.2;
    command.azimuth_rate = 0.1;
    run(3.0, command);
    EXPECT_NEAR(simulator_->truth().length - length, 0.6, 0.06);
    EXPECT_NEAR(frame_.reel.value.length, simulator_->truth().length, 0.01);
    EXPECT_NEAR(frame_.angles.value.phi, simulator_->truth().tangent_azimuth, 0.05);
    EXPECT_NEAR(frame_.reel.value.tension.value(), simulator_->truth().reel_tension, 0.3);
    VehicleCommand stop;
    stop.action = VehicleAction::kMotorStop;
    run(0.01, stop);
    run(0.2, VehicleCommand{});
    EXPECT_EQ(frame_.vehicle.value.phase, VehiclePhase::kStopped);
    EXPECT_FALSE(simulator_->truth().motors_on);
    const LinkStatus link = device_.status();
    EXPECT_GT(link.lines_ok, 4000U);
    EXPECT_EQ(link.lines_bad, 0U);
    EXPECT_EQ(link.timeouts, 0U);
  }

 private:
  static constexpr Time kStart{std::chrono::seconds(100)};

  sim::CanLink& link_;
  TautlineDevice device_;
  std::unique_ptr<sim::Simulator> simulator_;
  SensorFrame frame_;
  Time now_{kStart};
  std::array<std::uint8_t, 4096> buffer_{};
};

}  // namespace tautline::bench
