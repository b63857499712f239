#include "drivers/tautline_codec.h"

#include <algorithm>
#include <bit>
#include <boost/crc.hpp>
#include <cmath>

namespace tautline::bus {
namespace {

using Crc8 = boost::crc_optimal<8, kCrc8Polynomial, kCrc8Initial, kCrc8FinalXor, false, false>;

constexpr std::array kReelSignals{Signal{"counts", 0, 24, true, kCountUnit},
                                  Signal{"speed", 24, 14, true, kSpeedUnit},
                                  Signal{"tension", 38, 14, false, kTensionUnit}};
constexpr std::array kAnglesSignals{Signal{"elevation", 0, 16, true, kAngleUnit},
                                    Signal{"azimuth", 16, 16, true, kAngleUnit},
                                    Signal{"status", 32, 8, false, 1.0}};
constexpr std::array kAttitudeSignals{
    Signal{"q_w", 0, 13, true, kQuaternionUnit}, Signal{"q_x", 13, 13, true, kQuaternionUnit},
    Signal{"q_y", 26, 13, true, kQuaternionUnit}, Signal{"q_z", 39, 13, true, kQuaternionUnit}};
constexpr std::array kVehicleSignals{Signal{"flight_mode", 0, 4, false, 1.0},
                                     Signal{"flags", 4, 8, false, 1.0},
                                     Signal{"battery", 12, 10, false, kVoltageUnit},
                                     Signal{"gimbal_pitch", 22, 9, true, kGimbalUnit},
                                     Signal{"rate_x", 31, 7, true, kBodyRateUnit},
                                     Signal{"rate_y", 38, 7, true, kBodyRateUnit},
                                     Signal{"rate_z", 45, 7, true, kBodyRateUnit}};
constexpr std::array kRatesSignals{Signal{"length_rate", 0, 13, true, kSpeedUnit},
                                   Signal{"elevation_rate", 13, 13, true, kAngleUnit},
                                   Signal{"azimuth_rate", 26, 13, true, kAngleUnit},
                                   Signal{"yaw_rate", 39, 13, true, kAngleUnit}};
constexpr std::array kModeSignals{Signal{"mode", 0, 4, false, 1.0},
                                  Signal{"reel_controller", 4, 1, false, 1.0},
                                  Signal{"gimbal_pitch_rate", 8, 16, true, kAngleUnit},
                                  Signal{"gimbal_roll_rate", 24, 16, true, kAngleUnit}};

constexpr std::array kLayouts{MessageLayout{kReelId, "REEL", kMaxData, kReelSignals},
                              MessageLayout{kAnglesId, "ANGLES", kMaxData, kAnglesSignals},
                              MessageLayout{kAttitudeId, "ATTITUDE", kMaxData, kAttitudeSignals},
                              MessageLayout{kVehicleId, "VEHICLE", kMaxData, kVehicleSignals},
                              MessageLayout{kRatesId, "RATES", kMaxData, kRatesSignals},
                              MessageLayout{kModeId, "MODE", kModeSize, kModeSignals}};
constexpr std::size_t kMostSignals = 7;
using Values = std::array<double, kMostSignals>;

constexpr std::uint64_t maskOf(unsigned width) noexcept { return (std::uint64_t{1} << width) - 1; }

const MessageLayout* layoutOf(std::uint16_t id) noexcept {
  const auto it = std::find_if(kLayouts.begin(), kLayouts.end(),
                               [id](const MessageLayout& layout) { return layout.id == id; });
  return it == kLayouts.end() ? nullptr : &*it;
}

std::uint64_t wordOf(const BusFrame& frame) noexcept {
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < frame.data.size(); ++i)
    word |= std::uint64_t{frame.data[i]} << (8 * i);
  return word;
}

double unpack(std::uint64_t word, const Signal& s) noexcept {
  const std::uint64_t raw = (word >> s.start) & maskOf(s.width);
  const bool negative = s.is_signed && (raw >> (s.width - 1U)) != 0;
  const auto number = static_cast<std::int64_t>(raw) - (negative ? std::int64_t{1} << s.width : 0);
  return static_cast<double>(number) * s.unit;
}

std::uint64_t pack(double value, const Signal& s) noexcept {
  const auto largest = static_cast<double>(maskOf(s.is_signed ? s.width - 1U : s.width));
  const double smallest = s.is_signed ? -largest - 1.0 : 0.0;
  const double scaled = std::isfinite(value) ? std::clamp(value / s.unit, smallest, largest) : 0.0;
  return (static_cast<std::uint64_t>(std::llround(scaled)) & maskOf(s.width)) << s.start;
}

BusFrame frameOf(std::uint16_t id, std::uint8_t alive, const Values& values) noexcept {
  const MessageLayout& layout = *layoutOf(id);
  std::uint64_t word = 0;
  for (std::size_t i = 0; i < layout.signals.size(); ++i)
    word |= pack(values[i], layout.signals[i]);
  BusFrame frame;
  frame.id = id;
  frame.size = layout.size;
  for (std::size_t i = 0; i + 1U < layout.size; ++i)
    frame.data[i] = static_cast<std::uint8_t>(word >> (8 * i));
  const std::size_t crc = layout.size - 1U;
  frame.data[crc - 1] =
      static_cast<std::uint8_t>((frame.data[crc - 1] & 0x0FU) | (alive % kAliveModulus) << 4U);
  frame.data[crc] = crc8(id, std::span(frame.data.data(), crc));
  return frame;
}

template <class Enum>
bool isIn(Enum value, Enum first, Enum last) noexcept {
  return value >= first && value <= last;
}

double clampRate(double rate, double limit) noexcept {
  return std::isfinite(rate) ? std::clamp(rate, -limit, limit) : 0.0;
}

/// False if a value is none that a working device sends.
bool fill(const Values& v, std::uint16_t id, Parsed& out) noexcept {
  switch (id) {
    case kReelId:
      out.value = Reel{static_cast<std::int32_t>(std::lround(v[0] / kCountUnit)), v[1], v[2]};
      return true;
    case kAnglesId:
      out.value = Angles{v[0], v[1], static_cast<SensorStatus>(std::lround(v[2]))};
      return kElevationRange.contains(v[0]);
    case kAttitudeId: {
      out.value = Attitude{v[0], v[1], v[2], v[3]};
      const double norm = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
      return std::abs(norm - 1.0) <= kQuaternionTolerance;
    }
    case kVehicleId: {
      const auto mode = static_cast<FlightMode>(std::lround(v[0]));
      out.value = VehicleStatus{
          mode, static_cast<std::uint8_t>(std::lround(v[1])), v[2], v[3], v[4], v[5], v[6]};
      return isIn(mode, FlightMode::kIdle, FlightMode::kFault);
    }
    case kRatesId:
      out.value = Rates{v[0], v[1], v[2], v[3]};
      return true;
    default: {
      const auto mode = static_cast<BusMode>(std::lround(v[0]));
      out.value = ModeCommand{mode, v[1] != 0.0, v[2], v[3]};
      return isIn(mode, BusMode::kDisarmed, BusMode::kStop);
    }
  }
}

}  // namespace

std::span<const MessageLayout> layouts() noexcept { return kLayouts; }

std::uint8_t crc8(std::uint16_t id, std::span<const std::uint8_t> data) noexcept {
  Crc8 crc;
  crc.process_byte(static_cast<std::uint8_t>(id & 0xFFU));
  crc.process_byte(static_cast<std::uint8_t>(id >> 8U));
  crc.process_bytes(data.data(), data.size());
  return crc.checksum();
}

Parsed parse(const BusFrame& frame) noexcept {
  Parsed out;
  const MessageLayout* const layout = layoutOf(frame.id);
  if (layout == nullptr) {
    out.error = MessageError::kUnknownId;
    return out;
  }
  if (frame.size != layout->size) {
    out.error = MessageError::kSize;
    return out;
  }
  const std::size_t crc = layout->size - 1U;
  if (crc8(frame.id, std::span(frame.data.data(), crc)) != frame.data[crc]) {
    out.error = MessageError::kCrc;
    return out;
  }
  out.alive = static_cast<std::uint8_t>(frame.data[crc - 1] >> 4U);
  const std::uint64_t word = wordOf(frame);
  Values values{};
  for (std::size_t i = 0; i < layout->signals.size(); ++i)
    values[i] = unpack(word, layout->signals[i]);
  if (!fill(values, frame.id, out)) {
    out.error = MessageError::kOutOfRange;
    out.value = std::monostate{};
  }
  return out;
}

BusFrame encode(const Reel& m, std::uint8_t alive) noexcept {
  return frameOf(kReelId, alive, {m.counts * kCountUnit, m.speed, m.tension});
}

BusFrame encode(const Angles& m, std::uint8_t alive) noexcept {
  return frameOf(kAnglesId, alive,
                 {m.elevation, m.azimuth, static_cast<double>(static_cast<int>(m.status))});
}

BusFrame encode(const Attitude& m, std::uint8_t alive) noexcept {
  return frameOf(kAttitudeId, alive, {m.w, m.x, m.y, m.z});
}

BusFrame encode(const VehicleStatus& m, std::uint8_t alive) noexcept {
  return frameOf(kVehicleId, alive,
                 {static_cast<double>(static_cast<int>(m.mode)), static_cast<double>(m.flags),
                  m.battery_voltage, m.gimbal_pitch, m.p, m.q, m.r});
}

BusFrame encode(const Rates& m, std::uint8_t alive) noexcept {
  return frameOf(kRatesId, alive,
                 {clampRate(m.length, kMaxLengthRate), clampRate(m.elevation, kMaxAngleRate),
                  clampRate(m.azimuth, kMaxAngleRate), clampRate(m.yaw, kMaxAngleRate)});
}

BusFrame encode(const ModeCommand& m, std::uint8_t alive) noexcept {
  return frameOf(
      kModeId, alive,
      {static_cast<double>(static_cast<int>(m.mode)), m.reel_controller ? 1.0 : 0.0,
       clampRate(m.gimbal_pitch, kMaxGimbalRate), clampRate(m.gimbal_roll, kMaxGimbalRate)});
}

EndToEnd EndToEndCheck::check(Time now, const Parsed& message) noexcept {
  if (message.error != MessageError::kNone && message.error != MessageError::kOutOfRange)
    return EndToEnd::kError;
  const std::optional<std::uint8_t> before = last_alive_;
  last_alive_ = message.alive;
  if (before && *before == message.alive) return EndToEnd::kRepeated;
  if (before && last_ok_ && (*before + 1U) % kAliveModulus != message.alive)
    return EndToEnd::kWrongSequence;
  last_ok_ = now;
  return message.error == MessageError::kNone ? EndToEnd::kOk : EndToEnd::kError;
}

bool EndToEndCheck::timedOut(Time now, Duration timeout) noexcept {
  if (!last_ok_ || now - *last_ok_ <= timeout) return false;
  last_ok_.reset();
  return true;
}

}  // namespace tautline::bus
