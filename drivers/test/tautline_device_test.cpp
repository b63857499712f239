#include "drivers/tautline_device.h"

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/can_socket.h"
#include "drivers/cobs_port.h"
#include "drivers/serial_port.h"
#include "drivers/test/can_pair.h"
#include "drivers/test/pty.h"

namespace tautline {
namespace {

using bus::BusMode;
using testing::CanPair;
using testing::Pty;
using namespace std::chrono_literals;

constexpr double kPi = std::numbers::pi;

/// What a device on the bus sends, with its alive counters.
class Sensors {
 public:
  template <class Message>
  BusFrame next(const Message& message, unsigned stream) {
    return bus::encode(message, static_cast<std::uint8_t>(alive_[stream]++ % 16));
  }
  void skip(unsigned stream, unsigned frames = 1) { alive_[stream] += frames; }

 private:
  std::array<unsigned, 4> alive_{};
};

/// One of the two links, with the far end in the test's hands.
class Link {
 public:
  virtual ~Link() = default;
  virtual FramePort& port() = 0;
  virtual void send(const BusFrame& frame) = 0;
  virtual std::vector<BusFrame> receive() = 0;
};

class CanLink final : public Link {
 public:
  CanLink() : socket_(CanConfig{.interface = ""}, kTautlineIds) {
    EXPECT_TRUE(socket_.adopt(pair.release()));
  }
  FramePort& port() override { return socket_; }
  void send(const BusFrame& frame) override { ASSERT_TRUE(pair.send(frame)); }
  std::vector<BusFrame> receive() override {
    std::vector<BusFrame> out;
    for (const can_frame& got : pair.receive()) {
      BusFrame frame;
      frame.id = static_cast<std::uint16_t>(got.can_id);
      frame.size = got.can_dlc;
      std::copy_n(std::begin(got.data), got.can_dlc, frame.data.begin());
      out.push_back(frame);
    }
    return out;
  }

  CanPair pair;

 private:
  CanSocket socket_;
};

class SerialLink final : public Link {
 public:
  SerialLink() : serial_(config()), cobs_(serial_) { EXPECT_TRUE(serial_.open()); }
  FramePort& port() override { return cobs_; }
  void send(const BusFrame& frame) override {
    const bus::SerialFrame sent = bus::encodeSerial(frame);
    pty.send({reinterpret_cast<const char*>(sent.buffer.data()), sent.size});
  }
  std::vector<BusFrame> receive() override {
    std::vector<BusFrame> out;
    const std::string bytes = pty.receive();
    assembler_.push({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                    [&out](const bus::DecodedSerial& d) {
                      EXPECT_EQ(d.error, bus::FramingError::kNone);
                      out.push_back(d.frame);
                    });
    return out;
  }

  Pty pty;

 private:
  SerialConfig config() {
    SerialConfig config;
    config.device = pty.path();
    config.baud = bus::kDefaultBaud;
    return config;
  }
  SerialPort serial_;
  CobsPort cobs_;
  bus::FrameAssembler assembler_;
};

/// A loop at 100 Hz on virtual time.
class Rig {
 public:
  explicit Rig(Link& link, const TautlineConfig& config = {})
      : link_(link), device_(link.port(), config, "tautline-test") {}

  void sendSensorsNow(double length = 2.0) {
    link_.send(
        sensors.next(bus::Reel{static_cast<std::int32_t>(std::lround(length * 1e4)), 0.1, 1.5}, 0));
    link_.send(sensors.next(bus::Angles{0.5, -0.25, status}, 1));
    link_.send(sensors.next(bus::Attitude{1.0, 0.0, 0.0, 0.0}, 2));
    link_.send(sensors.next(
        bus::VehicleStatus{bus::FlightMode::kFlying, bus::kLowBattery, 15.0, -0.3, 0, 0, 0}, 3));
  }
  std::vector<BusFrame> run(Duration duration, const VehicleCommand& command = {}) {
    std::vector<BusFrame> sent;
    for (const Time end = now + duration; now < end; now += 10ms) {
      if (!silent) sendSensorsNow();
      device_.read(now, frame);
      device_.write(now, command);
      for (const BusFrame& f : link_.receive()) sent.push_back(f);
    }
    return sent;
  }
  TautlineDevice& device() { return device_; }

  Sensors sensors;
  SensorFrame frame;
  Time now{5s};
  bool silent{false};
  bus::SensorStatus status{bus::SensorStatus::kGood};

 private:
  Link& link_;
  TautlineDevice device_;
};

template <class T>
std::vector<T> of(const std::vector<BusFrame>& frames) {
  std::vector<T> out;
  for (const BusFrame& frame : frames) {
    const bus::Parsed parsed = bus::parse(frame);
    if (const T* value = std::get_if<T>(&parsed.value)) out.push_back(*value);
  }
  return out;
}

VehicleCommand flying() {
  VehicleCommand command;
  command.engaged = true;
  command.reel_controller = true;
  return command;
}

/// Everything that does not depend on the link, over both.
class TautlineDeviceTest : public ::testing::TestWithParam<const char*> {
 protected:
  static std::unique_ptr<Link> makeLink() {
    if (std::string(GetParam()) == "can") return std::make_unique<CanLink>();
    return std::make_unique<SerialLink>();
  }
  std::unique_ptr<Link> link_{makeLink()};
  Rig rig_{*link_};
};

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

TEST_P(TautlineDeviceTest, NamesASilentLinkAndItsReturn) {
  rig_.run(1500ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kNone);
  rig_.silent = true;
  rig_.run(2100ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kSilent);
  rig_.silent = false;
  rig_.run(20ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kNone);
}

TEST_P(TautlineDeviceTest, NamesASensorAtAnotherRate) {
  rig_.run(1500ms);
  for (const int more : {2, 0}) {  // the reel three times as often as agreed, then right again
    for (int i = 0; i < 350; ++i) {
      for (int k = 0; k < more; ++k) link_->send(rig_.sensors.next(bus::Reel{20000, 0, 0}, 0));
      rig_.run(10ms);
    }
    EXPECT_EQ(rig_.frame.link.fault, more > 0 ? LinkFault::kSensorRate : LinkFault::kNone);
  }
  EXPECT_TRUE(rig_.frame.reel.valid);
}

TEST_P(TautlineDeviceTest, NamesASensorThatIsTooSlow) {
  rig_.silent = true;
  for (int i = 0; i < 350; ++i) {
    if (i % 3 == 0) rig_.sendSensorsNow();
    rig_.run(10ms);
  }
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kSensorRate);
}

TEST_P(TautlineDeviceTest, NamesTwoSendersOfOneMessage) {
  Sensors second;
  second.skip(0, 7);
  for (int i = 0; i < 350; ++i) {
    link_->send(second.next(bus::Reel{1, 0, 0}, 0));
    rig_.run(10ms);
  }
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kUnreliable);
}

TEST_P(TautlineDeviceTest, NamesAnotherStation) {
  link_->send(bus::encode(bus::Rates{}, 3));
  rig_.run(20ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kAnotherStation);
  rig_.run(2100ms);
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kNone);
}

TEST_P(TautlineDeviceTest, NamesFramesOfAnotherProtocol) {
  rig_.silent = true;
  for (int i = 0; i < 250; ++i) {
    BusFrame frame;
    frame.id = static_cast<std::uint16_t>(0x300 + i % 5);
    frame.size = 8;
    link_->send(frame);
    rig_.run(10ms);
  }
  EXPECT_EQ(rig_.frame.link.fault, LinkFault::kOtherProtocol);
  EXPECT_FALSE(rig_.frame.reel.valid);
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
                         [](const auto& link) { return std::string(link.param); });

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

TEST(TautlineDeviceOnSerial, NamesGarbageAndText) {
  SerialLink link;
  Rig rig(link);
  rig.silent = true;
  unsigned noise = 1;
  for (int i = 0; i < 250; ++i) {
    std::string bytes;
    for (int k = 0; k < 20; ++k) {
      noise = noise * 1664525U + 1013904223U;
      bytes.push_back(static_cast<char>(noise >> 24U));
    }
    link.pty.send(bytes);
    rig.run(10ms);
  }
  EXPECT_EQ(rig.frame.link.fault, LinkFault::kGarbage);
  EXPECT_GT(rig.frame.link.lines_bad, 0U);
  for (int i = 0; i < 250; ++i) {
    link.pty.send("!Pos 0.78,-0.52,1.20\r\n");
    rig.run(10ms);
  }
  EXPECT_EQ(rig.frame.link.fault, LinkFault::kOtherProtocol);
  rig.silent = false;
  rig.run(20ms);
  EXPECT_EQ(rig.frame.link.fault, LinkFault::kNone);
}

TEST(TautlineDeviceOnSerial, StartsAnewAfterReplugging) {
  SerialLink link;
  Rig rig(link);
  rig.run(100ms, flying());
  const bus::SerialFrame cut = bus::encodeSerial(rig.sensors.next(bus::Reel{1, 0, 0}, 0));
  link.pty.send({reinterpret_cast<const char*>(cut.buffer.data()), 5});
  rig.silent = true;
  rig.run(20ms, flying());
  link.pty.unplug();
  for (int i = 0; i < 50; ++i, rig.now += 10ms) rig.device().read(rig.now, rig.frame);
  EXPECT_FALSE(rig.frame.link.connected);
  EXPECT_EQ(rig.frame.link.fault, LinkFault::kNone);
  link.pty.plug();
  rig.run(2s, flying());
  EXPECT_TRUE(rig.frame.link.connected);
  EXPECT_EQ(rig.frame.link.reconnects, 1U);
  rig.silent = false;
  rig.sensors.skip(0, 5);  // the device has counted on
  const std::uint32_t bad = rig.frame.link.lines_bad;
  const auto modes = of<bus::ModeCommand>(rig.run(100ms, flying()));
  EXPECT_EQ(rig.frame.link.lines_bad, bad);
  ASSERT_FALSE(modes.empty());
  EXPECT_EQ(modes.front().mode, BusMode::kArmed);
}

}  // namespace
}  // namespace tautline
