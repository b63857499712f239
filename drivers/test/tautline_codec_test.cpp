#include "drivers/tautline_codec.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <random>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "drivers/test/tautline_golden.h"

namespace tautline::bus {
namespace {

using namespace std::chrono_literals;
using testing::frameOf;

template <class T>
T valueOf(const testing::GoldenFrame& golden) {
  const Parsed parsed = parse(frameOf(golden.candump));
  EXPECT_EQ(parsed.error, MessageError::kNone) << golden.candump;
  const T* const value = std::get_if<T>(&parsed.value);
  EXPECT_NE(value, nullptr) << golden.candump;
  return value != nullptr ? *value : T{};
}

std::string candump(const BusFrame& frame) {
  std::array<char, 32> text{};
  int size = std::snprintf(text.data(), text.size(), "%03X#", frame.id);
  for (const std::uint8_t byte : frame.bytes())
    size += std::snprintf(text.data() + size, text.size() - static_cast<std::size_t>(size), "%02X",
                          byte);
  return text.data();
}

TEST(TautlineCodec, ReadsGoldenSensorFrames) {
  const auto reel = valueOf<Reel>(testing::kReelGolden);
  EXPECT_EQ(reel.counts, 123456);
  EXPECT_NEAR(reel.speed, 0.25, 1e-12);
  EXPECT_NEAR(reel.tension, 1.234, 1e-12);
  const auto limits = valueOf<Reel>(testing::kReelLimitsGolden);
  EXPECT_EQ(limits.counts, -1);
  EXPECT_NEAR(limits.speed, -8.192, 1e-12);
  EXPECT_NEAR(limits.tension, 16.383, 1e-12);
  const auto angles = valueOf<Angles>(testing::kAnglesGolden);
  EXPECT_NEAR(angles.elevation, 0.5236, 1e-12);
  EXPECT_NEAR(angles.azimuth, -1.5708, 1e-12);
  EXPECT_EQ(angles.status, SensorStatus::kGood);
  EXPECT_EQ(valueOf<Angles>(testing::kAnglesFaultGolden).status, SensorStatus::kFault);
  const auto yaw = valueOf<Attitude>(testing::kAttitudeYawGolden);
  EXPECT_NEAR(yaw.w, std::sqrt(0.5), 1e-4);
  EXPECT_NEAR(yaw.y, std::sqrt(0.5), 1e-4);
  EXPECT_EQ(yaw.x, 0.0);
  const auto vehicle = valueOf<VehicleStatus>(testing::kVehicleGolden);
  EXPECT_EQ(vehicle.mode, FlightMode::kFlying);
  EXPECT_EQ(vehicle.flags, kLowBattery | kNoCommands);
  EXPECT_NEAR(vehicle.battery_voltage, 15.2, 1e-12);
  EXPECT_NEAR(vehicle.gimbal_pitch, -0.35, 1e-12);
  EXPECT_NEAR(vehicle.p, 0.1, 1e-12);
  EXPECT_NEAR(vehicle.q, -0.2, 1e-12);
  EXPECT_NEAR(vehicle.r, 3.15, 1e-12);
  EXPECT_EQ(parse(frameOf(testing::kReelGolden.candump)).alive, 3);
}

TEST(TautlineCodec, WritesGoldenFrames) {
  EXPECT_EQ(candump(encode(Rates{0.3, 0.1, -0.05, 0.2}, 4)), testing::kRatesGolden.candump);
  EXPECT_EQ(candump(encode(ModeCommand{BusMode::kTakeoff, true, 0.3, -0.1}, 12)),
            testing::kTakeoffGolden.candump);
  EXPECT_EQ(candump(encode(ModeCommand{}, 16)), testing::kDisarmedGolden.candump);
  EXPECT_EQ(candump(encode(Reel{123456, 0.25, 1.234}, 3)), testing::kReelGolden.candump);
  EXPECT_EQ(candump(encode(Angles{0.5236, -1.5708, SensorStatus::kGood}, 0)),
            testing::kAnglesGolden.candump);
  EXPECT_EQ(candump(encode(Attitude{1.0, 0.0, 0.0, 0.0}, 7)),
            testing::kAttitudeLevelGolden.candump);
  EXPECT_EQ(candump(encode(VehicleStatus{FlightMode::kFlying, kLowBattery | kNoCommands, 15.2,
                                         -0.35, 0.1, -0.2, 3.15},
                           1)),
            testing::kVehicleGolden.candump);
}

// The catalogue's check value of CRC-8/SAE-J1850 for "123456789": '1' and '2' as the identifier.
TEST(TautlineCodec, ChecksumIsSaeJ1850) {
  const std::array<std::uint8_t, 7> rest{'3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc8(0x3231, rest), 0x4B);
}

TEST(TautlineCodec, EveryFlippedBitOfDataOrIdentifierIsNoticed) {
  for (const testing::GoldenFrame& golden : testing::kGoldenFrames) {
    const BusFrame frame = frameOf(golden.candump);
    for (unsigned bit = 0; bit < frame.size * 8U; ++bit) {
      BusFrame bad = frame;
      bad.data[bit / 8] = static_cast<std::uint8_t>(bad.data[bit / 8] ^ (1U << (bit % 8)));
      EXPECT_EQ(parse(bad).error, MessageError::kCrc) << golden.candump << " bit " << bit;
    }
    for (const std::uint16_t id : {kReelId, kAnglesId, kAttitudeId, kVehicleId, kRatesId}) {
      if (id == frame.id || frame.size != kMaxData) continue;
      BusFrame moved = frame;
      moved.id = id;
      EXPECT_EQ(parse(moved).error, MessageError::kCrc) << golden.candump << " as " << id;
    }
  }
}

TEST(TautlineCodec, NamesWhatIsWrong) {
  BusFrame frame = frameOf(testing::kReelGolden.candump);
  frame.id = 0x234;
  EXPECT_EQ(parse(frame).error, MessageError::kUnknownId);
  frame.id = kReelId;
  frame.size = 7;
  EXPECT_EQ(parse(frame).error, MessageError::kSize);
  EXPECT_EQ(parse(encode(Attitude{0.5, 0.0, 0.0, 0.0}, 0)).error, MessageError::kOutOfRange);
  EXPECT_EQ(parse(encode(Angles{1.63, 0.0, SensorStatus::kGood}, 0)).error,
            MessageError::kOutOfRange);
  EXPECT_EQ(parse(encode(VehicleStatus{static_cast<FlightMode>(9)}, 0)).error,
            MessageError::kOutOfRange);
  EXPECT_EQ(parse(encode(ModeCommand{static_cast<BusMode>(7)}, 0)).error,
            MessageError::kOutOfRange);
}

TEST(TautlineCodec, RatesAreClampedAndNeverNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  const Parsed parsed = parse(encode(Rates{1e9, -9.0, nan, infinite}, 0));
  const Rates rates = std::get<Rates>(parsed.value);
  EXPECT_NEAR(rates.length, kMaxLengthRate, 1e-12);
  EXPECT_NEAR(rates.elevation, -kMaxAngleRate, 1e-12);
  EXPECT_EQ(rates.azimuth, 0.0);
  EXPECT_EQ(rates.yaw, 0.0);
}

TEST(TautlineCodec, EveryValueComesBackWithinHalfAUnit) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const auto alive = static_cast<std::uint8_t>(i % 16);
    const Reel reel{static_cast<std::int32_t>(unit(random) * 8388607), 8.19 * unit(random),
                    16.38 * std::abs(unit(random))};
    const Parsed back = parse(encode(reel, alive));
    ASSERT_EQ(back.error, MessageError::kNone);
    EXPECT_EQ(back.alive, alive);
    EXPECT_EQ(std::get<Reel>(back.value).counts, reel.counts);
    EXPECT_NEAR(std::get<Reel>(back.value).speed, reel.speed, kSpeedUnit / 2 + 1e-12);
    EXPECT_NEAR(std::get<Reel>(back.value).tension, reel.tension, kTensionUnit / 2 + 1e-12);
    const Angles angles{1.57 * unit(random), 3.14 * unit(random), SensorStatus::kStarting};
    const Angles angles_back = std::get<Angles>(parse(encode(angles, alive)).value);
    EXPECT_NEAR(angles_back.elevation, angles.elevation, kAngleUnit / 2 + 1e-12);
    EXPECT_NEAR(angles_back.azimuth, angles.azimuth, kAngleUnit / 2 + 1e-12);
  }
}

// The .dbc file is written by hand; it has to say what the codec does.
TEST(TautlineCodec, DbcFileHasTheSameLayout) {
  std::ifstream file(std::string(TAUTLINE_SOURCE_DIR) + "/config/tautline.dbc");
  ASSERT_TRUE(file.good());
  struct DbcSignal {
    int start{0}, width{0};
    char sign{'?'};
    double unit{0.0};
  };
  std::map<int, std::map<std::string, DbcSignal>> messages;
  std::map<int, int> sizes;
  int id = -1;
  for (std::string line; std::getline(file, line);) {
    std::array<char, 64> name{};
    int number = 0;
    int size = 0;
    if (std::sscanf(line.c_str(), "BO_ %d %63[^:]: %d", &number, name.data(), &size) == 3) {
      id = number;
      sizes[id] = size;
    }
    DbcSignal s;
    if (std::sscanf(line.c_str(), " SG_ %63s : %d|%d@1%c (%lf,0)", name.data(), &s.start, &s.width,
                    &s.sign, &s.unit) == 5)
      messages[id][name.data()] = s;
  }
  ASSERT_EQ(messages.size(), layouts().size());
  for (const MessageLayout& layout : layouts()) {
    auto& signals = messages[layout.id];
    EXPECT_EQ(sizes[layout.id], layout.size) << layout.name;
    EXPECT_EQ(signals.size(), layout.signals.size() + 2) << layout.name;
    for (const Signal& s : layout.signals) {
      EXPECT_EQ(signals[s.name].start, s.start) << layout.name << "." << s.name;
      EXPECT_EQ(signals[s.name].width, s.width) << layout.name << "." << s.name;
      EXPECT_EQ(signals[s.name].sign, s.is_signed ? '-' : '+') << layout.name << "." << s.name;
      EXPECT_DOUBLE_EQ(signals[s.name].unit, s.unit) << layout.name << "." << s.name;
    }
    EXPECT_EQ(signals["alive"].start, 8 * layout.size - 12) << layout.name;
    EXPECT_EQ(signals["crc"].start, 8 * layout.size - 8) << layout.name;
  }
}

class EndToEndTest : public ::testing::Test {
 protected:
  EndToEnd receive(unsigned alive, bool garbled = false) {
    now_ += 10ms;
    BusFrame frame = encode(Reel{}, static_cast<std::uint8_t>(alive));
    if (garbled) frame.data[0] ^= 0x10;
    return check_.check(now_, parse(frame));
  }
  Time now_{1s};
  EndToEndCheck check_;
};

TEST_F(EndToEndTest, FollowsTheCounterRoundItsEnd) {
  for (unsigned i = 5; i < 60; ++i) EXPECT_EQ(receive(i % 16), EndToEnd::kOk) << i;
}

TEST_F(EndToEndTest, TellsRepeatedLostAndGarbledFrames) {
  EXPECT_EQ(receive(3), EndToEnd::kOk);
  EXPECT_EQ(receive(3), EndToEnd::kRepeated);
  EXPECT_EQ(receive(4), EndToEnd::kOk);
  EXPECT_EQ(receive(5, true), EndToEnd::kError);
  EXPECT_EQ(receive(6), EndToEnd::kWrongSequence);  // 5 never came
  EXPECT_EQ(receive(7), EndToEnd::kOk);
}

TEST_F(EndToEndTest, NeverLetsAnOlderFrameThrough) {
  EXPECT_EQ(receive(1), EndToEnd::kOk);
  EXPECT_EQ(receive(3), EndToEnd::kWrongSequence);
  EXPECT_EQ(receive(2), EndToEnd::kWrongSequence);
  EXPECT_EQ(receive(4), EndToEnd::kWrongSequence);
  EXPECT_EQ(receive(5), EndToEnd::kOk);
}

TEST_F(EndToEndTest, TimesOutOnceAndStartsAnew) {
  constexpr Duration kTimeout = kTimeoutPeriods * kSensorPeriod;
  EXPECT_FALSE(check_.timedOut(now_ + 10s, kTimeout)) << "nothing has come yet";
  EXPECT_EQ(receive(1), EndToEnd::kOk);
  EXPECT_FALSE(check_.timedOut(now_ + 30ms, kTimeout));
  EXPECT_TRUE(check_.timedOut(now_ + 31ms, kTimeout));
  EXPECT_FALSE(check_.timedOut(now_ + 32ms, kTimeout));
  EXPECT_EQ(receive(9), EndToEnd::kOk);
}

TEST_F(EndToEndTest, AStuckSenderTimesOutAndStaysOut) {
  EXPECT_EQ(receive(2), EndToEnd::kOk);
  int timeouts = 0;
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(receive(2), EndToEnd::kRepeated);
    timeouts += check_.timedOut(now_, kTimeoutPeriods * kSensorPeriod) ? 1 : 0;
  }
  EXPECT_EQ(timeouts, 1);
}

}  // namespace
}  // namespace tautline::bus
