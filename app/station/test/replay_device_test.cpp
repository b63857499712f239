#include "app/station/replay_device.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "common/error.h"
#include "common/testing/malloc_guard.h"
#include "common/tether_geometry.h"

namespace tautline {
namespace {

using namespace std::chrono_literals;

/// A flight of three seconds: the reel at 100 Hz, the angles every half second.
Recording shortFlight() {
  Recording recording;
  SensorFrame frame;
  frame.link.connected = true;
  for (int i = 0; i <= 300; ++i) {
    const Time now = Time{1000s} + i * 10ms;
    update(frame.reel, now - 3ms,
           ReelReading{.counts = 1.0 * i, .length = 0.01 * i, .tension = {}});
    if (i % 50 == 0)
      update(frame.angles, now, TetherAngles{.theta = 0.001 * i, .phi = 0.0, .altitude = {}});
    recording.cycles.push_back({now, frame});
  }
  return recording;
}

TEST(ReplayDevice, SaysWhatTheSensorsSaidWhenTheySaidIt) {
  ReplayDevice device(shortFlight(), 1.0);
  SensorFrame frame;
  for (int i = 0; i <= 300; ++i) {
    device.read(Time{7s} + i * 10ms, frame);
    ASSERT_EQ(frame.reel.value.counts, i);
    ASSERT_EQ(frame.reel.sequence, static_cast<std::uint32_t>(i + 1));
    ASSERT_EQ(frame.reel.time, Time{7s} + i * 10ms - 3ms);
    ASSERT_EQ(frame.angles.sequence, static_cast<std::uint32_t>(i / 50 + 1));
    ASSERT_TRUE(frame.link.connected);
  }
  EXPECT_TRUE(device.ended());
  device.read(Time{7s} + 3010ms, frame);
  EXPECT_FALSE(frame.link.connected);
  EXPECT_EQ(frame.reel.sequence, 301U);
}

TEST(ReplayDevice, RunsAtAnySpeed) {
  for (const double speed : {0.5, 4.0}) {
    ReplayDevice device(shortFlight(), speed);
    SensorFrame frame;
    int cycles = 0;
    for (; !device.ended(); ++cycles) {
      device.read(Time{7s} + cycles * 10ms, frame);
      ASSERT_LE(frame.reel.time, Time{7s} + cycles * 10ms);
    }
    EXPECT_NEAR(cycles, 300.0 / speed, 2.0);
  }
}

TEST(ReplayDevice, TouchesNoHeap) {
  if (!testing::MallocGuard::available())
    GTEST_SKIP() << "a sanitizer owns malloc in this build: nothing to count";
  ReplayDevice device(shortFlight(), 1.0);
  SensorFrame frame;
  const testing::MallocGuard guard;
  for (int i = 0; i < 400; ++i) {
    device.read(Time{} + i * 10ms, frame);
    device.write(Time{} + i * 10ms, VehicleCommand{});
  }
  EXPECT_EQ(guard.allocations() + guard.deallocations(), 0);
}

std::filesystem::path written(const std::string& name, const std::string& text) {
  const auto path = std::filesystem::path(::testing::TempDir()) / ("tautline_replay_" + name);
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

std::string row(int second, double length, double elevation, double azimuth, double contact) {
  const auto text = [](double value) { return " " + std::to_string(value); };
  return "201802051740" + std::to_string(10 + second) + " 0 0 0 1 1 1 0 0 0" + text(length) +
         text(elevation) + text(azimuth) + text(contact) + text(contact) + text(contact) +
         " 6.95e-310 1e+231 0 0.4 0.1 0 \n";
}

TEST(ReadRecording, ReadsATextLog) {
  const auto file = written(
      "flight.txt", row(0, 0.0, 1.57, 0.0, 0.0033) + "no row\n" + row(1, 1.0, 0.5, -0.25, 0.0033) +
                        row(1, 1.0, 0.5, -0.25, 0.0033) + row(2, 1.2, 0.5, -0.25, 1.0));
  const Recording recording = readRecording(file);
  ASSERT_EQ(recording.cycles.size(), 3U);
  EXPECT_EQ(recording.skipped, 2);
  EXPECT_TRUE(recording.isTextLog());
  EXPECT_EQ(recording.length(), 1s);
  EXPECT_EQ(recording.cycles[1].now - recording.cycles[0].now, 500ms);
  const SensorFrame& last = recording.cycles[2].sensors;
  EXPECT_EQ(recording.cycles[1].sensors.reel.sequence, 1U);  // the same value within a second
  EXPECT_EQ(last.reel.sequence, 2U);
  EXPECT_NEAR(last.angles.value.theta, 0.5, 1e-9);
  EXPECT_NEAR(last.angles.value.phi, -0.25 + std::numbers::pi / 2, 1e-9);
  EXPECT_EQ(recording.poses[0].anchor.contact_count, 0);
  EXPECT_EQ(recording.poses[2].anchor.contact_count, 1);
  EXPECT_NEAR(last.reel.value.length, 1.2, 1e-9);
  EXPECT_NEAR(recording.poses[2].anchor.L_static, std::sqrt(3.0), 1e-9);  // not less than straight
}

TEST(ReadRecording, RefusesWhatIsNoFlight) {
  EXPECT_THROW(static_cast<void>(readRecording("/no/such/file")), InputError);
  EXPECT_THROW(static_cast<void>(readRecording(written("empty", ""))), InputError);
  EXPECT_THROW(static_cast<void>(readRecording(written("text", "hello, this is no flight\n"))),
               InputError);
  EXPECT_THROW(static_cast<void>(readRecording(written("lcm", "\xED\xA1\xDA\x01garbage"))),
               InputError);
}

}  // namespace
}  // namespace tautline
