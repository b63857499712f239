// What faults do to what a client hears and says: sensors, vehicle, clock, link and bus.

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim_hil/fault.h"
#include "sim_hil/frame_faults.h"
#include "sim_hil/link_faults.h"
#include "sim_hil/simulator.h"
#include "sim_hil/tautline_wire.h"
#include "sim_hil/test/flight_rig.h"
#include "sim_hil/test/wire_client.h"

namespace tautline::sim {
namespace {

using std::chrono::milliseconds;

/// A client of the Fotokite protocol that flies, with its telemetry at 10 Hz.
class Telegrams : public ::testing::Test {
 protected:
  Telegrams() : sim_(calmConfig(), emptyRoom(), 1) {
    say(WireClient::startSequence());
    run(1.0);
    say("StartTakeoff\n");
    run(9.0);
    client_.resetCounts();
  }
  void say(const std::string& text) {
    sim_.receive({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  void run(double seconds, const std::string& command = "Pos2 0,0,0") {
    const int ticks = static_cast<int>(std::lround(seconds / 0.01));
    for (int i = 0; i < ticks; ++i) {
      if (i % 10 == 0) say(command + "\n");
      now_ += milliseconds(10);
      sim_.advanceTo(now_);
      std::array<std::uint8_t, 1024> out;
      const std::size_t n = sim_.transmit(out);
      client_.take(std::string(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(n)));
    }
  }
  void inject(const std::string& target, const std::string& mode, double for_s = 1000.0) {
    inject(target, mode, for_s, makeFault(target, mode).value);
  }
  void inject(const std::string& target, const std::string& mode, double for_s, double value) {
    Fault f = makeFault(target, mode);
    f.at = now_;
    f.lasting = fromSeconds(for_s);
    f.value = value;
    ASSERT_TRUE(sim_.inject(f));
  }
  double counts() const { return client_.number("!GSStatus", 3); }
  double elevation() const { return std::numbers::pi / 2.0 - client_.number("!Pos", 0); }
  double voltage() const { return client_.number("!GSStatus", 2); }
  int flags() const { return static_cast<int>(client_.number("!FlightStatus", 3)); }
  int flightMode() const { return static_cast<int>(client_.number("!FlightStatus", 0)); }
  /// Pay-out at 0.285 m/s: 100 counts a second.
  static constexpr const char* kOut = "Pos2 0,0,100";

  Simulator sim_;
  WireClient client_;
  Time now_{};
};

struct SensorLine {
  const char* target;
  const char* header;
};
class SensorLines : public Telegrams, public ::testing::WithParamInterface<SensorLine> {};

TEST_P(SensorLines, OffSlowAndIntermittentSilenceThisLineOnly) {
  const auto [target, header] = GetParam();
  inject(target, "off", 2.0);
  run(2.0);
  EXPECT_LE(client_.count(header), 1);
  EXPECT_GE(client_.count("!FlightStatus"), 19);
  client_.resetCounts();
  inject(target, "slow", 10.0, 1.0);
  run(10.0);
  EXPECT_NEAR(client_.count(header), 10, 2);
  client_.resetCounts();
  inject(target, "intermittent", 40.0, 0.5);
  run(40.0);
  EXPECT_NEAR(client_.count(header), 200, 60);
  client_.resetCounts();
  run(2.0);
  EXPECT_NEAR(client_.count(header), 20, 1) << "healed";
}
INSTANTIATE_TEST_SUITE_P(All, SensorLines,
                         ::testing::Values(SensorLine{"encoder", "!GSStatus"},
                                           SensorLine{"angles", "!Pos"},
                                           SensorLine{"attitude", "!Attitude"}),
                         [](const auto& p) { return std::string(p.param.target); });

TEST_F(Telegrams, StuckEncoderStandsWhileTheReelRuns) {
  const double before = counts();
  const double length = sim_.truth().length;
  inject("encoder", "stuck", 2.0);
  run(2.0, kOut);
  EXPECT_EQ(counts(), before);
  EXPECT_NEAR(sim_.truth().length - length, 0.285 * 1.9, 0.02);
  run(0.3);
  EXPECT_NEAR(counts() - before, 195, 15);
}

TEST_F(Telegrams, WrongEncoderReadsTooMuch) {
  const double before = counts();
  inject("encoder", "wrong", 1000.0, 0.57);
  run(0.3);
  EXPECT_EQ(counts() - before, 200) << "0.57 m in counts of 2.85 mm";
}

TEST_F(Telegrams, DelayedEncoderIsLateByItsTime) {
  inject("encoder", "delayed", 1000.0, 1.0);
  run(4.0, kOut);
  // At 100 counts a second, one second is 100 counts.
  const double present = (sim_.truth().length) / 0.00285;
  EXPECT_NEAR(present - counts(), 100, 15);
}

TEST_F(Telegrams, GarbageEncoderJumps) {
  inject("encoder", "garbage");
  double least = 1e9;
  double most = -1e9;
  for (int i = 0; i < 50; ++i) {
    run(0.1);
    least = std::fmin(least, counts());
    most = std::fmax(most, counts());
  }
  EXPECT_LT(least, -5000);
  EXPECT_GT(most, 5000);
}

TEST_F(Telegrams, AnglesWrongAndStuck) {
  const double before = elevation();
  inject("angles", "wrong", 2.0, 0.3);
  run(1.0);
  EXPECT_NEAR(elevation() - before, 0.3, 0.03);
  run(2.0);
  inject("angles", "stuck", 2.0);
  run(0.2);
  const double stuck = elevation();
  run(1.5, "Pos2 0.2,0,0");
  EXPECT_EQ(elevation(), stuck);
  EXPECT_GT(sim_.truth().tangent_elevation - stuck, 0.15);
}

TEST_F(Telegrams, AttitudeWrongTurnsTheQuaternion) {
  const double w = client_.number("!Attitude", 0);
  inject("attitude", "wrong", 1000.0, 0.8);
  run(0.3);
  // A level vehicle turned by 0.8 rad about one axis has w = cos 0.4, up to its own small lean.
  EXPECT_NEAR(client_.number("!Attitude", 0), std::cos(0.4), 0.08);
  EXPECT_GT(w, 0.98);
}

TEST_F(Telegrams, BatteryFaultsAreSeenAndActedOnByTheMachine) {
  const double before = voltage();
  inject("battery", "wrong", 3.0, -1.4);
  run(1.0);
  EXPECT_NEAR(voltage(), before - 1.4, 0.02);
  EXPECT_EQ(flags() & 0x40, 0x40) << "LOW_BATT below 11.1 V";
  run(3.0);
  EXPECT_EQ(flags() & 0x44, 0);
  inject("battery", "off");
  run(1.0);
  EXPECT_EQ(voltage(), 0.0);
  EXPECT_EQ(flightMode(), 48) << "an empty battery lands";
}

TEST_F(Telegrams, FlagsAndModesAreReported) {
  int bit = 1;
  for (const VehicleCode& flag : vehicleFlags()) {
    inject(std::string("flag:") + flag.name, "on", 0.4);
    run(0.35);
    EXPECT_EQ(flags() & bit, bit) << flag.name;
    run(0.3);
    bit <<= 1;
  }
  EXPECT_EQ(flags(), 0);
  for (const int mode : {1, 2, 3, 5, 48, 49, 50, 52, 53, 54, 55}) {
    const auto modes = vehicleFlightModes();
    const auto named = std::find_if(modes.begin(), modes.end(),
                                    [&](const VehicleCode& c) { return c.fotokite == mode; });
    ASSERT_NE(named, modes.end()) << mode;
    inject(std::string("mode:") + named->name, "on", 0.4);
    run(0.35);
    EXPECT_EQ(flightMode(), mode);
    run(0.3);
  }
  EXPECT_EQ(flightMode(), 2);
  EXPECT_TRUE(sim_.truth().motors_on) << "only said, not done";
}

TEST_F(Telegrams, TheDevicesClockTimesWhatItSends) {
  inject("clock", "stuck", 2.0);
  run(2.0);
  EXPECT_LE(client_.count("!Pos"), 1);
  client_.resetCounts();
  inject("clock", "slow", 10.0, 0.5);
  run(10.0);
  EXPECT_NEAR(client_.count("!Pos"), 50, 3);
  const double run_time = client_.number("!GSStatus", 1);
  run(1.0);
  inject("clock", "wrong", 1.0, 100.0);
  run(0.5);
  EXPECT_NEAR(client_.number("!GSStatus", 1) - run_time, 101.5, 0.2);
}

TEST_F(Telegrams, LinkOffIsSilentBothWaysAndTheMachineStopsByItself) {
  const double before = sim_.truth().length;
  inject("link.vehicle", "off", 3.0);
  run(0.1);
  run(2.9, kOut);
  EXPECT_LE(client_.count("!Pos"), 1);
  EXPECT_LT(sim_.truth().length - before, 0.01) << "no command arrived";
  client_.resetCounts();
  run(2.0, kOut);
  EXPECT_NEAR(client_.count("!Pos"), 20, 2);
  EXPECT_GT(sim_.truth().length - before, 0.4);
}

TEST_F(Telegrams, UplinkOffLeavesTelemetry) {
  inject("link.uplink", "off", 1.5);
  const double before = sim_.truth().length;
  run(0.1);
  run(1.4, kOut);
  EXPECT_GE(client_.count("!Pos"), 14);
  EXPECT_LT(sim_.truth().length - before, 0.01);
  EXPECT_EQ(flags() & 0x8, 0x8) << "NO_SYNC_CMDS";
}

TEST_F(Telegrams, DelayedLinkKeepsEverythingInOrder) {
  inject("link.vehicle", "delayed", 5.0, 0.5);
  run(0.45);
  EXPECT_LE(client_.count("!Pos"), 1);
  const double before = sim_.truth().length;
  run(0.45, kOut);
  EXPECT_LT(sim_.truth().length - before, 1e-3) << "the command is still under way";
  run(3.0, kOut);
  EXPECT_GT(sim_.truth().length - before, 0.5);
  run(4.0);
  EXPECT_EQ(client_.badLines(), 0);
  EXPECT_NEAR(client_.count("!Pos"), 79, 8) << "nothing was lost";
}

TEST_F(Telegrams, GarbageDamagesItsShareOfTheBytes) {
  inject("link.vehicle", "garbage", 20.0, 0.002);
  run(20.0);
  // About 250 bytes in ten lines a turn: with 0.2 % of the bytes, some lines and far from all.
  EXPECT_GT(client_.badLines() + 200 - client_.count("!Pos"), 3);
  EXPECT_GT(client_.count("!Pos"), 120);
}

TEST_F(Telegrams, SlowLinkPassesItsBytesASecond) {
  FaultSchedule faults(1);
  Fault slow = makeFault("link.vehicle", "slow");
  slow.value = 500.0;
  ASSERT_TRUE(faults.add(slow));
  FaultyLink link(false);
  std::array<std::uint8_t, 100> in{};
  std::array<std::uint8_t, 4096> out{};
  std::size_t passed = 0;
  for (int i = 0; i < 1000; ++i) {
    faults.update(Time{} + milliseconds(10 * i));
    ASSERT_TRUE(link.needed(faults));
    link.put(in, faults);
    passed += link.take(out, faults);
  }
  EXPECT_NEAR(static_cast<double>(passed), 5000.0, 150.0);
}

/// Frames of the bus through FrameFaults: alive counter in the last byte but one.
struct Counted {
  int intact{0};
  int damaged{0};
  int repeated{0};
  int out_of_order{0};
};
Counted passFrames(const char* mode, double share, int frames) {
  FaultSchedule faults(5);
  if (mode != nullptr) {
    Fault f = makeFault("bus", mode);
    f.value = share;
    EXPECT_TRUE(faults.add(f));
  }
  faults.update(Time{} + milliseconds(1));
  FrameFaults stage;
  Counted seen;
  int last = -1;
  for (int i = 0; i < frames; ++i) {
    TautlineFrame frame;
    frame.id = 0x100;
    frame.size = 8;
    frame.data = {
        1, 2, 3, 4, static_cast<std::uint8_t>(i & 0xFF), static_cast<std::uint8_t>(i >> 8), 7, 8};
    for (FrameFaults::Result passed = stage.pass(frame, faults); !passed.empty();) {
      const TautlineFrame f = passed.take();
      const int number = f.data[4] | f.data[5] << 8;
      const bool whole = f.data[0] == 1 && f.data[1] == 2 && f.data[2] == 3 && f.data[3] == 4 &&
                         f.data[6] == 7 && f.data[7] == 8 && number <= i;
      whole ? ++seen.intact : ++seen.damaged;
      if (number == last) ++seen.repeated;
      if (whole && number < last) ++seen.out_of_order;
      last = std::max(last, number);
    }
  }
  return seen;
}

TEST(BusFaults, EachDoesItsShareAndNothingElse) {
  const Counted good = passFrames(nullptr, 0.0, 1000);
  EXPECT_EQ(good.intact, 1000);
  EXPECT_EQ(good.repeated + good.out_of_order + good.damaged, 0);
  const Counted dup = passFrames("dup", 0.3, 1000);
  EXPECT_NEAR(dup.repeated, 300, 50);
  EXPECT_EQ(dup.intact, 1000 + dup.repeated);
  EXPECT_EQ(dup.out_of_order, 0);
  const Counted reorder = passFrames("reorder", 0.3, 1000);
  EXPECT_NEAR(reorder.intact, 1000, 1);
  EXPECT_NEAR(reorder.out_of_order, 230, 50) << "0.3 of those that follow a message in its place";
  EXPECT_EQ(reorder.repeated, 0);
  const Counted crc = passFrames("crc", 0.3, 1000);
  EXPECT_NEAR(crc.damaged, 300 * 6 / 8, 60) << "two of the eight bytes are the test's own count";
}

TEST(BusFaults, BusOffIsSilence) {
  SimConfig config = calmConfig();
  config.device = SimDevice::kTautlineSerial;
  Simulator sim(config, emptyRoom(), 1);
  std::array<std::uint8_t, 4096> out{};
  sim.advanceTo(Time{} + std::chrono::seconds(1));
  EXPECT_GT(sim.transmit(out), 1000U);
  Fault off = makeFault("bus", "busoff");
  off.at = sim.now();
  off.lasting = std::chrono::seconds(2);
  ASSERT_TRUE(sim.inject(off));
  sim.advanceTo(Time{} + milliseconds(2000));
  EXPECT_EQ(sim.transmit(out), 0U);
  sim.advanceTo(Time{} + milliseconds(3100));
  static_cast<void>(sim.transmit(out));
  sim.advanceTo(Time{} + milliseconds(3600));
  EXPECT_GT(sim.transmit(out), 500U);
}

TEST(Determinism, TheSameFaultsGiveTheSameBytes) {
  std::string bytes[2];
  for (std::string& run : bytes) {
    Simulator sim(SimConfig{}, emptyRoom(), 9);
    for (const char* text : {"encoder garbage 2 5", "link.vehicle garbage 3 5 0.1",
                             "angles intermittent 1 8 0.2", "reel garbage 1 5"}) {
      ASSERT_TRUE(sim.inject(parseFault(text)));
    }
    const std::string start = WireClient::startSequence();
    sim.receive({reinterpret_cast<const std::uint8_t*>(start.data()), start.size()});
    std::array<std::uint8_t, 4096> out{};
    for (int i = 1; i < 1000; ++i) {
      sim.advanceTo(Time{} + milliseconds(10 * i));
      const std::size_t n = sim.transmit(out);
      run.append(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(n));
    }
  }
  EXPECT_GT(bytes[0].size(), 5000U);
  EXPECT_TRUE(bytes[0] == bytes[1]);
}

}  // namespace
}  // namespace tautline::sim
