// The menu of faults, how a fault is written, and what decides whether it acts.

#include "sim_hil/fault.h"

#include <set>

#include <gtest/gtest.h>

#include "common/error.h"
#include "sim_hil/fault_file.h"
#include "sim_hil/fault_schedule.h"

namespace tautline::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

ExitCode codeOf(const std::string& text) {
  try {
    static_cast<void>(parseFault(text));
  } catch (const InputError& e) {
    return e.code();
  }
  return ExitCode::kOk;
}

TEST(FaultMenu, EveryKindIsThereOnceWithItsValueInItsRange) {
  std::set<std::pair<FaultTarget, FaultMode>> seen;
  for (const FaultKind& kind : faultMenu()) {
    EXPECT_TRUE(seen.insert({kind.target, kind.mode}).second);
    EXPECT_NE(kind.mode, FaultMode::kOk);
    EXPECT_STRNE(kind.effect, "");
    EXPECT_TRUE(kind.range.contains(kind.initial)) << kind.effect;
    EXPECT_EQ(findFaultKind(kind.target, kind.mode), &kind);
  }
}

TEST(FaultMenu, EveryPairIsEitherOnTheMenuOrRefused) {
  int accepted = 0;
  for (const auto& target : kFaultTargetNames) {
    const bool named =
        target.value == FaultTarget::kFlag || target.value == FaultTarget::kFlightMode;
    const std::string text =
        std::string(target.name) + (!named                               ? ""
                                    : target.value == FaultTarget::kFlag ? ":MOTOR_ERROR"
                                                                         : ":TIMEOUT");
    for (const auto& mode : kFaultModeNames) {
      const FaultKind* kind = findFaultKind(target.value, mode.value);
      const bool can =
          mode.value == FaultMode::kOk || (kind != nullptr && kind->place != FaultPlace::kNowhere);
      const std::string line = text + " " + mode.name + " 1";
      EXPECT_EQ(codeOf(line), can ? ExitCode::kOk : ExitCode::kUsage) << line;
      accepted += can ? 1 : 0;
    }
  }
  EXPECT_GT(accepted, 70);
}

TEST(FaultMenu, FlagsAndModesAreThoseOfTheProtocol) {
  EXPECT_EQ(vehicleFlags().size(), 13U);
  EXPECT_EQ(vehicleFlightModes().size(), 11U);
  unsigned bits = 0;
  for (const VehicleCode& flag : vehicleFlags()) bits |= static_cast<unsigned>(flag.fotokite);
  EXPECT_EQ(bits, 0x1FFFU);
}

TEST(ParseFault, ReadsTimesAndValues) {
  const Fault f = parseFault("encoder wrong 10 5 -0.25");
  EXPECT_EQ(f.target, FaultTarget::kEncoder);
  EXPECT_EQ(f.mode, FaultMode::kWrong);
  EXPECT_EQ(f.at, Time{} + seconds(10));
  EXPECT_EQ(f.lasting, seconds(5));
  EXPECT_EQ(f.value, -0.25);
  EXPECT_EQ(parseFault("encoder wrong 10").lasting, Fault::kForEver);
  EXPECT_EQ(parseFault("encoder wrong 10 0").value, 0.5) << "the menu's value";
  const Fault gust = parseFault("air gust 1 2 3,0,-1");
  EXPECT_EQ(gust.velocity, Eigen::Vector3d(3.0, 0.0, -1.0));
  EXPECT_EQ(describe(parseFault("flag:HARD_KILL on 1")), "flag:HARD_KILL on");
}

TEST(ParseFault, ReadsBackWhatFaultTextWrites) {
  for (const char* text : {"encoder wrong 10.25 5 -0.1", "encoder off 0", "air gust 1 2 3,0.1,-1",
                           "flag:HARD_KILL on 0.003 4", "mode:TIMEOUT on 1", "tether ok 2",
                           "bus unplug 3 4", "reel slow 0 60 0.02"}) {
    const Fault f = parseFault(text);
    const Fault again = parseFault(faultText(f));
    EXPECT_EQ(describe(again), describe(f)) << text;
    EXPECT_EQ(again.at, f.at) << text;
    EXPECT_EQ(again.lasting, f.lasting) << text;
    EXPECT_EQ(again.value, f.value) << text;
    EXPECT_EQ(again.velocity, f.velocity) << text;
  }
}

TEST(ParseFault, RefusesWhatIsNone) {
  for (const char* text : {"", "encoder", "encoder off", "encoder off soon", "encoder off 1 2 3 4",
                           "encoder off 1e999", "gps off 1", "flag on 1", "flag:WINGS on 1",
                           "encoder:left off 1", "air gust 1 2 3"}) {
    EXPECT_EQ(codeOf(text), ExitCode::kUsage) << text;
  }
}

TEST(CheckFault, KnowsDevicesAndPlaces) {
  const auto refused = [](const char* text, SimDevice device, bool on_bench) {
    try {
      checkFault(parseFault(text), device, on_bench);
      return false;
    } catch (const InputError&) {
      return true;
    }
  };
  EXPECT_FALSE(refused("encoder off 1", SimDevice::kFotokite, false));
  EXPECT_TRUE(refused("bus crc 1", SimDevice::kFotokite, true));
  EXPECT_FALSE(refused("bus crc 1", SimDevice::kTautlineSerial, false));
  EXPECT_FALSE(refused("bus unplug 1", SimDevice::kFotokite, false));
  EXPECT_TRUE(refused("bus unplug 1", SimDevice::kTautlineCan, false)) << "not its cable";
  EXPECT_TRUE(refused("loop delayed 1", SimDevice::kFotokite, false));
  EXPECT_FALSE(refused("loop delayed 1", SimDevice::kFotokite, true));
  EXPECT_TRUE(refused("flag:I2C_ERROR on 1", SimDevice::kTautlineSerial, true));
  EXPECT_FALSE(refused("mode:HARD_KILL on 1", SimDevice::kTautlineSerial, true));
  EXPECT_TRUE(refused("encoder delayed 1 1 9", SimDevice::kFotokite, true))
      << "value beyond its range";
  EXPECT_TRUE(refused("air gust 1 1 99,0,0", SimDevice::kFotokite, true));
  EXPECT_FALSE(refused("disk ok 1", SimDevice::kFotokite, true));
}

TEST(ReadFaults, FromAFileWithLineNumbers) {
  TomlTable root =
      TomlFile::parse(
          "[[fault]]\ntarget = \"tether\"\nmode = \"snag\"\nphase = \"AUTO\"\nat_s = 2\n"
          "for_s = 3\nvalue = 0.5\n",
          "s.toml")
          .root();
  const auto faults = readFaults(root);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].phase, "AUTO");
  EXPECT_EQ(faults[0].fault.at, Time{} + seconds(2));
  EXPECT_EQ(faults[0].fault.value, 0.5);
  TomlTable bad =
      TomlFile::parse("[[fault]]\ntarget = \"disk\"\nmode = \"off\"\n", "bad.toml").root();
  try {
    static_cast<void>(readFaults(bad));
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_EQ(e.problem().file, "bad.toml");
    EXPECT_EQ(e.problem().line, 2);
  }
}

Fault fault(FaultMode mode, double at_s, double for_s) {
  Fault f;
  f.target = FaultTarget::kEncoder;
  f.mode = mode;
  f.at = Time{} + fromSeconds(at_s);
  f.lasting = fromSeconds(for_s);
  f.value = 0.2;
  return f;
}

TEST(FaultSchedule, ActsInItsTimeAndMixes) {
  FaultSchedule faults(1);
  ASSERT_TRUE(faults.add(fault(FaultMode::kStuck, 1.0, 2.0)));
  ASSERT_TRUE(faults.add(fault(FaultMode::kSlow, 2.0, 4.0)));
  ASSERT_TRUE(faults.add(fault(FaultMode::kOk, 4.0, 1.0)));
  const auto active = [&](double t, FaultMode mode) {
    faults.update(Time{} + fromSeconds(t));
    return faults.active(FaultTarget::kEncoder, mode) != nullptr;
  };
  EXPECT_FALSE(active(0.9, FaultMode::kStuck));
  EXPECT_TRUE(active(1.0, FaultMode::kStuck));
  EXPECT_FALSE(active(1.0, FaultMode::kSlow));
  EXPECT_TRUE(active(2.5, FaultMode::kStuck));
  EXPECT_TRUE(active(2.5, FaultMode::kSlow));
  EXPECT_EQ(faults.active(FaultTarget::kAngles, FaultMode::kSlow), nullptr);
  EXPECT_FALSE(active(3.5, FaultMode::kStuck));
  EXPECT_FALSE(active(4.5, FaultMode::kSlow)) << "ok comes before everything";
  EXPECT_TRUE(active(5.5, FaultMode::kSlow));
  EXPECT_FALSE(active(6.0, FaultMode::kSlow));
  EXPECT_TRUE(faults.empty());
  for (std::size_t i = 0; i < kMaxFaults; ++i)
    EXPECT_TRUE(faults.add(fault(FaultMode::kOff, 9, 1)));
  EXPECT_FALSE(faults.add(fault(FaultMode::kOff, 9, 1)));
}

TEST(LooseContact, IsOpenForHalfTheTimeInTurnsOfItsLength) {
  FaultSchedule faults(3);
  ASSERT_TRUE(faults.add(fault(FaultMode::kIntermittent, 0.0, 1000.0)));
  LooseContact contact;
  int open = 0;
  int turns = 0;
  bool was = false;
  for (int i = 0; i < 40000; ++i) {
    faults.update(Time{} + milliseconds(10 * i));
    const bool is =
        contact.open(faults.active(FaultTarget::kEncoder, FaultMode::kIntermittent), faults);
    open += is ? 1 : 0;
    turns += is != was ? 1 : 0;
    was = is;
  }
  EXPECT_NEAR(open / 40000.0, 0.5, 0.05);
  EXPECT_NEAR(400.0 / turns, 0.2, 0.02);
}

TEST(History, GivesTheNewestThatIsOldEnough) {
  History<int, 8> history;
  for (int i = 0; i < 20; ++i) history.put(Time{} + seconds(i), i);
  EXPECT_EQ(history.at(Time{} + milliseconds(17500)), 17);
  EXPECT_EQ(history.at(Time{} + seconds(100)), 19);
  EXPECT_EQ(history.at(Time{}), 12) << "the oldest that is kept";
}

}  // namespace
}  // namespace tautline::sim
