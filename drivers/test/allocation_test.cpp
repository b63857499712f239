// After start-up nothing in the drivers touches the heap: not while flying, not on a bad line, not
// when the cable is pulled.

#include <linux/can/error.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string_view>

#include <gtest/gtest.h>

#include "common/testing/malloc_guard.h"
#include "drivers/can_socket.h"
#include "drivers/cobs_port.h"
#include "drivers/fotokite_device.h"
#include "drivers/serial_port.h"
#include "drivers/tautline_device.h"
#include "drivers/test/can_pair.h"
#include "drivers/test/pty.h"

namespace tautline {
namespace {

using testing::MallocGuard;
using testing::Pty;
using namespace std::chrono_literals;

constexpr int kCycles = 10000;
constexpr std::string_view kTelemetry =
    "!GSStatus 10,532.11,15.62,912\r\n!Attitude 0.71,0.00,-0.02,0.70\r\n!Gimbal "
    "0.98,0.00,-0.17,0.00\r\n"
    "!Pos 0.78,-0.52,1.20\r\n!FlightStatus 2,63.20,8.10,192\r\n!Pos 0.78,-0.5x\r\n!Pos "
    "1e400,nan,1\r\ngarbage\r\n";

VehicleCommand commandAt(int cycle) {
  VehicleCommand command;
  command.engaged = cycle % 500 > 20;
  command.reel_controller = cycle % 1000 > 500;
  command.length_rate = 1e-3 * (cycle % 200 - 100);
  command.elevation_rate = 1e-3 * (cycle % 300 - 150);
  command.gimbal_pitch_rate = 1e-3 * (cycle % 30);
  command.action = cycle % 700 < 50 ? VehicleAction::kTakeoff : VehicleAction::kNone;
  return command;
}

TEST(Allocation, NoneInTenThousandCyclesOnATerminal) {
  if (!MallocGuard::available())
    GTEST_SKIP() << "a sanitizer owns malloc in this build: nothing to count";
  Pty pty;
  SerialConfig config;
  config.device = pty.path();
  SerialPort port(config);
  ASSERT_TRUE(port.open());
  FotokiteConfig fast;
  fast.command_rate_hz = 100.0;
  FotokiteDevice device(port, fast);
  SensorFrame frame;
  std::array<char, 4096> sink{};
  long heap_calls = 0;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    if (cycle == kCycles / 2) pty.unplug();
    if (cycle == kCycles / 2 + 500) pty.plug();
    if (pty.master() >= 0) {
      pty.send(kTelemetry);
      // Now and then the far end does not read for a while, so that output has to be given up.
      if (cycle % 4000 < 2000) static_cast<void>(::read(pty.master(), sink.data(), sink.size()));
    }
    const Time now = Time{} + cycle * 10ms;
    const MallocGuard guard;
    device.read(now, frame);
    device.write(now, commandAt(cycle));
    heap_calls += guard.allocations() + guard.deallocations();
  }
  EXPECT_EQ(heap_calls, 0);
  const LinkStatus link = device.status();
  EXPECT_GT(link.lines_ok, 40000U);
  EXPECT_GT(link.lines_bad, 20000U);
  EXPECT_GT(link.bytes_dropped, 0U);
  EXPECT_EQ(link.reconnects, 1U);
}

/// 10,000 cycles of a device on the bus, between what `before` does to its far end in each of them.
template <class Before>
long heapCallsOf(TautlineDevice& device, SensorFrame& frame, Before&& before) {
  long heap_calls = 0;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    before(cycle);
    const Time now = Time{} + cycle * 10ms;
    const MallocGuard guard;
    device.read(now, frame);
    device.write(now, commandAt(cycle));
    heap_calls += guard.allocations() + guard.deallocations();
  }
  return heap_calls;
}

std::array<BusFrame, 5> sensorMessages(int cycle) {
  const auto alive = static_cast<std::uint8_t>(cycle % 16);
  std::array<BusFrame, 5> messages{
      bus::encode(bus::Reel{cycle, 0.1, 1.0}, alive), bus::encode(bus::Angles{0.5, 0.2, {}}, alive),
      bus::encode(bus::Attitude{}, alive), bus::encode(bus::VehicleStatus{}, alive), BusFrame{}};
  messages[4].id = 0x345;                            // someone else's
  if (cycle % 10 == 0) messages[1].data[0] ^= 0x01;  // garbled
  if (cycle % 50 < 2) messages[0] = messages[2];     // lost, and one twice
  return messages;
}

TEST(Allocation, NoneInTenThousandCyclesOnTheBus) {
  if (!MallocGuard::available())
    GTEST_SKIP() << "a sanitizer owns malloc in this build: nothing to count";
  testing::CanPair pair;
  CanSocket socket(CanConfig{.interface = "tautline_no0"}, kTautlineIds);
  ASSERT_TRUE(socket.adopt(pair.release()));
  TautlineDevice device(socket, TautlineConfig{}, "tautline-can");
  SensorFrame frame;
  const long heap_calls = heapCallsOf(device, frame, [&pair](int cycle) {
    if (cycle == 9000)
      pair.hangUp();  // from here on it tries to open an interface that is not there
    if (cycle >= 9000) return;
    for (const BusFrame& message : sensorMessages(cycle)) pair.send(message);
    can_frame error{};
    error.can_id = CAN_ERR_FLAG | CAN_ERR_ACK;
    if (cycle % 100 == 0) pair.send(error);
    // Now and then the far end does not read for a while, so that the bus takes no more.
    can_frame sink{};
    if (cycle % 4000 < 2000)
      while (::recv(pair.farEnd(), &sink, sizeof(sink), 0) > 0) continue;
  });
  EXPECT_EQ(heap_calls, 0);
  EXPECT_GT(device.status().lines_ok, 30000U);
  EXPECT_GT(device.status().check_errors, 800U);
  EXPECT_GT(device.status().repeated, 100U);
  EXPECT_GT(device.status().bytes_dropped, 0U);
  EXPECT_EQ(device.status().bus_errors, 90U);
  EXPECT_FALSE(device.status().connected);
}

TEST(Allocation, NoneInTenThousandCyclesOnTheSerialBus) {
  if (!MallocGuard::available())
    GTEST_SKIP() << "a sanitizer owns malloc in this build: nothing to count";
  Pty pty;
  SerialConfig config;
  config.device = pty.path();
  SerialPort serial(config);
  ASSERT_TRUE(serial.open());
  CobsPort cobs(serial);
  TautlineDevice device(cobs, TautlineConfig{}, "tautline-serial");
  SensorFrame frame;
  std::array<char, 4096> sink{};
  const long heap_calls = heapCallsOf(device, frame, [&](int cycle) {
    if (cycle == kCycles / 2) pty.unplug();
    if (cycle == kCycles / 2 + 500) pty.plug();
    if (pty.master() < 0) return;
    for (const BusFrame& message : sensorMessages(cycle)) {
      const bus::SerialFrame sent = bus::encodeSerial(message);
      pty.send({reinterpret_cast<const char*>(sent.buffer.data()), sent.size});
    }
    pty.send("noise");
    if (cycle % 4000 < 2000) static_cast<void>(::read(pty.master(), sink.data(), sink.size()));
  });
  EXPECT_EQ(heap_calls, 0);
  EXPECT_GT(device.status().lines_ok, 20000U);
  EXPECT_GT(device.status().lines_bad, 9000U);
  EXPECT_EQ(device.status().reconnects, 1U);
}

}  // namespace
}  // namespace tautline
