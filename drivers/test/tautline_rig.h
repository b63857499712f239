#pragma once

/// @file
/// A TautlineDevice in a loop at 100 Hz on virtual time, with the far end of its link, CAN or
/// serial, in the test's hands.

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/can_socket.h"
#include "drivers/cobs_port.h"
#include "drivers/serial_port.h"
#include "drivers/tautline_device.h"
#include "drivers/test/can_pair.h"
#include "drivers/test/pty.h"

namespace tautline::testing {

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
    for (const Time end = now + duration; now < end; now += kPeriod) {
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
  Time now{std::chrono::seconds(5)};
  bool silent{false};
  bus::SensorStatus status{bus::SensorStatus::kGood};

 private:
  static constexpr Duration kPeriod = std::chrono::milliseconds(10);
  Link& link_;
  TautlineDevice device_;
};

/// Those of `frames` that are messages of the type T.
template <class T>
std::vector<T> of(const std::vector<BusFrame>& frames) {
  std::vector<T> out;
  for (const BusFrame& frame : frames) {
    const bus::Parsed parsed = bus::parse(frame);
    if (const T* value = std::get_if<T>(&parsed.value)) out.push_back(*value);
  }
  return out;
}

inline VehicleCommand flying() {
  VehicleCommand command;
  command.engaged = true;
  command.reel_controller = true;
  return command;
}

/// What does not depend on the link, over both.
class OverBothLinks : public ::testing::TestWithParam<const char*> {
 protected:
  static std::unique_ptr<Link> makeLink() {
    if (std::string(GetParam()) == "can") return std::make_unique<CanLink>();
    return std::make_unique<SerialLink>();
  }
  std::unique_ptr<Link> link_{makeLink()};
  Rig rig_{*link_};
};

inline std::string linkName(const ::testing::TestParamInfo<const char*>& link) {
  return link.param;
}

}  // namespace tautline::testing
