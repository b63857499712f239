// After start-up nothing in the drivers touches the heap: not while flying, not on a bad line, not
// when the cable is pulled.

#include <unistd.h>

#include <array>
#include <string_view>

#include <gtest/gtest.h>

#include "common/testing/malloc_guard.h"
#include "drivers/fotokite_device.h"
#include "drivers/serial_port.h"
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

}  // namespace
}  // namespace tautline
