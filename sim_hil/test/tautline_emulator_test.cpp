#include "sim_hil/tautline_emulator.h"

#include <cmath>
#include <map>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "sim_hil/test/flight_rig.h"

namespace tautline::sim {
namespace {

using bus::BusMode;
using bus::FlightMode;

/// CRC-8 by polynomial division of the whole bit string: nothing of the emulator's.
std::uint8_t checksum(unsigned id, const std::uint8_t* data, std::size_t size) {
  std::vector<bool> bits;
  const auto add = [&bits](unsigned byte) {
    for (int i = 7; i >= 0; --i) bits.push_back((byte >> i & 1U) != 0);
  };
  add(id & 0xFFU);
  add(id >> 8U);
  for (std::size_t i = 0; i < size; ++i) add(data[i]);
  for (std::size_t i = 0; i < 8; ++i) bits[i] = !bits[i];  // initial value FF
  add(0);
  for (std::size_t i = 0; i + 8 < bits.size(); ++i) {
    if (!bits[i]) continue;
    for (const int tap : {0, 4, 5, 6, 8}) {  // x^8 + x^4 + x^3 + x^2 + 1
      const auto at = i + static_cast<std::size_t>(tap);
      bits[at] = !bits[at];
    }
  }
  unsigned crc = 0;
  for (std::size_t i = bits.size() - 8; i < bits.size(); ++i) crc = crc << 1U | (bits[i] ? 1U : 0U);
  return static_cast<std::uint8_t>(crc ^ 0xFFU);
}

/// A station written from config/tautline.dbc alone.
class Client {
 public:
  TautlineFrame rates(double length, double elevation, double azimuth) {
    return frame(0x200, 8,
                 part(length * 1000, 0, 13) | part(elevation * 10000, 13, 13) |
                     part(azimuth * 10000, 26, 13));
  }
  TautlineFrame mode(BusMode mode, bool reel = true) {
    return frame(0x210, 7, static_cast<unsigned>(mode) | (reel ? 0x10U : 0U));
  }
  static std::int64_t at(const TautlineFrame& f, unsigned start, unsigned width, bool is_signed) {
    std::int64_t value = 0;
    for (unsigned i = 0; i < width; ++i) {
      const unsigned bit = start + i;
      if ((f.data[bit / 8] >> (bit % 8) & 1) != 0) value += std::int64_t{1} << i;
    }
    const bool negative = is_signed && value >= std::int64_t{1} << (width - 1);
    return negative ? value - (std::int64_t{1} << width) : value;
  }

 private:
  static std::uint64_t part(double value, unsigned start, unsigned width) {
    return (static_cast<std::uint64_t>(std::llround(value)) & ((std::uint64_t{1} << width) - 1))
           << start;
  }
  TautlineFrame frame(unsigned id, std::uint8_t size, std::uint64_t bits) {
    TautlineFrame f;
    f.id = static_cast<std::uint16_t>(id);
    f.size = size;
    for (std::size_t i = 0; i + 1U < size; ++i)
      f.data[i] = static_cast<std::uint8_t>(bits >> 8 * i);
    f.data[size - 2U] = static_cast<std::uint8_t>(f.data[size - 2U] | (alive_[id]++ % 16) << 4U);
    f.data[size - 1U] = checksum(id, f.data.data(), size - 1U);
    return f;
  }
  std::map<unsigned, unsigned> alive_;
};

SimConfig busConfig() {
  SimConfig config = calmConfig();
  config.reel.metres_per_count = 1e-4;
  return config;
}

class TautlineEmulatorTest : public ::testing::Test {
 protected:
  /// Steps for `seconds`, sending rates every 10 ms where there are any; keeps what comes back.
  void run(double seconds, const double* rates = nullptr) {
    const int steps = static_cast<int>(std::lround(seconds / 0.002));
    for (int i = 0; i < steps; ++i) {
      if (rates != nullptr && i % 5 == 0)
        devices_.receive(client_.rates(rates[0], rates[1], rates[2]));
      if (rates != nullptr && i % 50 == 0) devices_.receive(client_.mode(BusMode::kArmed));
      plant_.step();
      devices_.advance();
      for (TautlineFrame f; devices_.transmit(f);) {
        ++count_[f.id];
        last_[f.id] = f;
        EXPECT_EQ(f.data[7], checksum(f.id, f.data.data(), 7));
      }
    }
  }
  void takeOff() {
    const double rest[3]{};
    run(0.1, rest);
    devices_.receive(client_.mode(BusMode::kTakeoff));
    run(8.0, rest);
    ASSERT_EQ(devices_.flightMode(), FlightMode::kFlying);
  }

  Plant plant_{busConfig(), emptyRoom(), 1};
  TautlineEmulator devices_{TautlineEmulatorConfig{}, plant_};
  Client client_;
  std::map<int, int> count_;
  std::map<int, TautlineFrame> last_;
};

TEST_F(TautlineEmulatorTest, EachSensorSendsAHundredTimesASecondWithItsAliveCounter) {
  run(1.0);
  for (const int id : {0x100, 0x110, 0x120, 0x121}) {
    EXPECT_NEAR(count_[id], 100, 1) << id;
    EXPECT_EQ(last_[id].data[6] >> 4, (count_[id] - 1) % 16) << id;
  }
}

TEST_F(TautlineEmulatorTest, SaysWhatThePlantIs) {
  run(1.0);
  const Truth& truth = plant_.truth();
  EXPECT_NEAR(static_cast<double>(Client::at(last_[0x100], 0, 24, true)) * 1e-4, truth.length,
              1e-3);
  EXPECT_NEAR(static_cast<double>(Client::at(last_[0x100], 38, 14, false)) * 1e-3,
              truth.reel_tension, 0.05);
  EXPECT_NEAR(static_cast<double>(Client::at(last_[0x110], 0, 16, true)) * 1e-4,
              truth.tangent_elevation, 0.05);
  EXPECT_NEAR(static_cast<double>(Client::at(last_[0x120], 0, 13, true)) / 4096.0, 1.0, 0.01);
  EXPECT_EQ(Client::at(last_[0x121], 0, 4, false), 1);
  EXPECT_NEAR(static_cast<double>(Client::at(last_[0x121], 12, 10, false)) * 0.05, 12.4, 0.06);
}

TEST_F(TautlineEmulatorTest, FliesAndFollowsRates) {
  takeOff();
  const double before = plant_.truth().length;
  const double out[3]{0.2, 0.0, 0.1};
  const double azimuth = plant_.truth().setpoint_azimuth;
  run(2.0, out);
  EXPECT_NEAR(plant_.truth().length - before, 0.4, 0.05);
  EXPECT_NEAR(plant_.truth().setpoint_azimuth - azimuth, 0.2, 0.01);
  EXPECT_EQ(Client::at(last_[0x121], 0, 4, false), 2);
}

TEST_F(TautlineEmulatorTest, StopsByItselfTwoHundredMillisecondsAfterTheLastRates) {
  takeOff();
  const double out[3]{0.2, 0.0, 0.1};
  run(1.0, out);
  run(0.15);
  const double azimuth = plant_.truth().setpoint_azimuth;
  run(0.03);
  EXPECT_GT(plant_.truth().setpoint_azimuth, azimuth) << "still within the time";
  run(0.1);
  const double stopped = plant_.truth().setpoint_azimuth;
  run(1.0);
  EXPECT_EQ(plant_.truth().setpoint_azimuth, stopped);
  EXPECT_LT(std::abs(plant_.reel().rate()), 1e-3);
  EXPECT_NE(devices_.flags() & bus::kNoCommands, 0);
  run(0.5, out);
  EXPECT_GT(plant_.truth().setpoint_azimuth, stopped) << "goes on when commands are back";
  EXPECT_EQ(devices_.flags() & bus::kNoCommands, 0);
  run(10.5);
  EXPECT_EQ(devices_.flightMode(), FlightMode::kLanding);
}

TEST_F(TautlineEmulatorTest, DisarmedNothingMoves) {
  takeOff();
  devices_.receive(client_.mode(BusMode::kDisarmed));
  const double azimuth = plant_.truth().setpoint_azimuth;
  for (int i = 0; i < 100; ++i) {
    devices_.receive(client_.rates(0.2, 0.1, 0.1));
    run(0.01);
  }
  EXPECT_EQ(plant_.truth().setpoint_azimuth, azimuth);
  EXPECT_LT(std::abs(plant_.reel().rate()), 1e-3);
}

TEST_F(TautlineEmulatorTest, RefusesWhatIsGarbledRepeatedOrForeign) {
  run(0.1);
  TautlineFrame good = client_.mode(BusMode::kTakeoff);
  TautlineFrame garbled = good;
  garbled.data[0] = static_cast<std::uint8_t>(garbled.data[0] ^ 1U);
  devices_.receive(garbled);
  devices_.receive({0x300, 8, {}});
  devices_.receive({0x200, 0, {}});
  EXPECT_EQ(devices_.refused(), 3U);
  EXPECT_FALSE(plant_.vehicle().motorsOn());
  devices_.receive(good);
  EXPECT_TRUE(plant_.vehicle().motorsOn());
  devices_.receive(good);
  EXPECT_EQ(devices_.refused(), 4U);
}

TEST_F(TautlineEmulatorTest, StopCutsTheMotors) {
  takeOff();
  devices_.receive(client_.mode(BusMode::kStop));
  EXPECT_FALSE(plant_.vehicle().motorsOn());
  EXPECT_EQ(devices_.flightMode(), FlightMode::kStopped);
}

}  // namespace
}  // namespace tautline::sim
