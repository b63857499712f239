#include "sim_hil/tautline_emulator.h"

#include <algorithm>
#include <cmath>

namespace tautline::sim {
namespace {

using bus::BusMode;
using bus::FlightMode;

constexpr Duration kStopShown = std::chrono::seconds(2);  // kStopped after a normal stop
constexpr double kSlackTension = 0.15;                    // a tether that only hangs pulls less [N]

/// CRC-8 SAE J1850 bit by bit, over the identifier and the first `size` bytes.
std::uint8_t checksum(const TautlineFrame& frame, std::size_t size) noexcept {
  unsigned crc = bus::kCrc8Initial;
  const auto add = [&crc](unsigned byte) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit)
      crc = (crc & 0x80U) != 0 ? ((crc << 1U) ^ bus::kCrc8Polynomial) & 0xFFU : (crc << 1U) & 0xFFU;
  };
  add(frame.id & 0xFFU);
  add(frame.id >> 8U);
  for (std::size_t i = 0; i < size; ++i) add(frame.data[i]);
  return static_cast<std::uint8_t>(crc ^ bus::kCrc8FinalXor);
}

/// `width` bits of `value`, in units, at bit `start`; clamped to what fits.
std::uint64_t field(double value, double unit, unsigned start, unsigned width, bool is_signed) {
  const double steps = std::round(value / unit);
  const double top = std::ldexp(1.0, static_cast<int>(is_signed ? width - 1 : width)) - 1.0;
  const double bottom = is_signed ? -top - 1.0 : 0.0;
  const auto number = static_cast<std::int64_t>(std::clamp(steps, bottom, top));
  const std::uint64_t mask = ~(~std::uint64_t{0} << width);
  return (static_cast<std::uint64_t>(number) & mask) << start;
}

/// A signed number of `width` bits at bit `start`.
std::int64_t signedAt(std::uint64_t bits, unsigned start, unsigned width) noexcept {
  // Shifted up so that its sign is the word's, and arithmetically down again.
  return static_cast<std::int64_t>(bits << (64U - width - start)) >> (64U - width);
}

double limited(double value, double limit) noexcept { return std::clamp(value, -limit, limit); }

}  // namespace

void TautlineEmulator::receive(const TautlineFrame& frame) noexcept {
  const bool is_rates = frame.id == bus::kRatesId && frame.size == bus::kMaxData;
  const bool is_mode = frame.id == bus::kModeId && frame.size == bus::kModeSize;
  if ((!is_rates && !is_mode) || checksum(frame, frame.size - 1U) != frame.data[frame.size - 1U]) {
    ++refused_;
    return;
  }
  const unsigned alive = frame.data[frame.size - 2U] >> 4U;
  std::optional<unsigned>& last = is_rates ? rates_alive_ : mode_alive_;
  if (last == alive) {
    ++refused_;
    return;
  }
  last = alive;
  std::uint64_t bits = 0;
  for (std::size_t i = frame.size; i-- > 0;) bits = bits << 8U | frame.data[i];
  if (!(is_rates ? obeyRates(bits) : obeyMode(bits))) ++refused_;
}

bool TautlineEmulator::obeyRates(std::uint64_t bits) noexcept {
  const auto rate = [bits](unsigned start, double unit, double limit) {
    return limited(static_cast<double>(signedAt(bits, start, 13)) * unit, limit);
  };
  length_rate_ = rate(0, bus::kSpeedUnit, bus::kMaxLengthRate);
  rates_.elevation = rate(13, bus::kAngleUnit, bus::kMaxAngleRate);
  rates_.azimuth = rate(26, bus::kAngleUnit, bus::kMaxAngleRate);
  rates_.yaw = rate(39, bus::kAngleUnit, bus::kMaxAngleRate);
  last_rates_ = plant_.clock();
  obeyRatesNow();
  return true;
}

bool TautlineEmulator::obeyMode(std::uint64_t bits) noexcept {
  const unsigned mode = bits & 0xFU;
  if (mode > static_cast<unsigned>(BusMode::kStop)) return false;
  mode_ = static_cast<BusMode>(mode);
  reel_controller_ = (bits >> 4U & 1U) != 0;
  const auto gimbal = [bits](unsigned start) {
    return limited(static_cast<double>(signedAt(bits, start, 16)) * bus::kAngleUnit,
                   bus::kMaxGimbalRate);
  };
  rates_.gimbal_pitch = gimbal(8);
  rates_.gimbal_roll = gimbal(24);
  if (mode_ == BusMode::kTakeoff) startTakeoff();
  if (mode_ == BusMode::kLand && flying()) plant_.vehicle().emergencyLand();
  if (mode_ == BusMode::kStop) stopMotors();
  obeyRatesNow();
  return true;
}

/// Rates count while armed; the reel follows while its controller is on.
void TautlineEmulator::obeyRatesNow() noexcept {
  const bool armed = mode_ == BusMode::kArmed || mode_ == BusMode::kTakeoff;
  if (!armed || commandsMissing()) {
    rest();
    return;
  }
  plant_.vehicle().command(rates_);
  plant_.reel().lock(!reel_controller_);
  plant_.reel().drive(length_rate_);
}

void TautlineEmulator::rest() noexcept {
  plant_.vehicle().command({});
  plant_.reel().drive(0.0);
  plant_.reel().lock(true);
}

void TautlineEmulator::startTakeoff() noexcept {
  const Truth& truth = plant_.truth();
  if (truth.crashed || !truth.on_ground || plant_.vehicle().motorsOn() || batteryTooLow()) return;
  stopped_in_air_ = false;
  plant_.vehicle().startTakeoff();
}

void TautlineEmulator::stopMotors() noexcept {
  if (!plant_.vehicle().motorsOn()) return;
  stopped_in_air_ = !plant_.truth().on_ground;
  plant_.vehicle().stopMotors();
}

void TautlineEmulator::advance() noexcept {
  const Time now = plant_.clock();
  const bool on = plant_.vehicle().motorsOn();
  if (was_on_ && !on) {
    motors_stopped_ = now;
    has_flown_ = true;
  }
  was_on_ = on;
  if (commandsMissing()) {
    rest();
    const bool long_silent =
        !last_rates_ || now - *last_rates_ > fromSeconds(config_.landing_timeout);
    if (flying() && long_silent) plant_.vehicle().emergencyLand();
  }
  if (flying() && plant_.batteryVoltage() < plant_.vehicle().config().battery_empty)
    plant_.vehicle().emergencyLand();
  if (now < next_sensors_) return;
  const Duration period = fromSeconds(1.0 / config_.sensor_rate);
  next_sensors_ += period;
  if (next_sensors_ <= now) next_sensors_ = now + period;  // no burst of missed messages
  sendSensors();
}

bool TautlineEmulator::commandsMissing() const noexcept {
  return !last_rates_ || plant_.clock() - *last_rates_ > bus::kCommandTimeout;
}

bool TautlineEmulator::flying() const noexcept {
  const FlightPhase phase = plant_.vehicle().phase();
  return phase == FlightPhase::kTakeoff || phase == FlightPhase::kFlying ||
         phase == FlightPhase::kEmergencyLand;
}

bool TautlineEmulator::batteryTooLow() const noexcept {
  return plant_.batteryVoltage() < plant_.vehicle().config().battery_critical;
}

FlightMode TautlineEmulator::flightMode() const noexcept {
  const FaultSchedule& faults = plant_.faults();
  if (const Fault* said = faults.active(FaultTarget::kFlightMode, FaultMode::kOn))
    return static_cast<FlightMode>(vehicleFlightModes()[said->code].tautline);
  if (plant_.truth().crashed) return FlightMode::kFault;
  const FlightPhase phase = plant_.vehicle().phase();
  if (phase == FlightPhase::kEmergencyLand) return FlightMode::kLanding;
  if (flying()) return FlightMode::kFlying;
  if (phase == FlightPhase::kParked && batteryTooLow()) return FlightMode::kFault;
  const bool just_stopped = has_flown_ && plant_.clock() - motors_stopped_ < kStopShown;
  return stopped_in_air_ || just_stopped ? FlightMode::kStopped : FlightMode::kIdle;
}

std::uint8_t TautlineEmulator::flags() const noexcept {
  const Vehicle& vehicle = plant_.vehicle();
  unsigned bits = 0;
  if (plant_.batteryVoltage() < vehicle.config().battery_low) bits |= bus::kLowBattery;
  if (batteryTooLow()) bits |= bus::kCriticalBattery;
  if (flying() && commandsMissing()) bits |= bus::kNoCommands;
  if (flying() && plant_.truth().tension < kSlackTension) bits |= bus::kSlackTether;
  plant_.faults().forEachActive(FaultTarget::kFlag, FaultMode::kOn, [&](const Fault& said) {
    bits |= static_cast<unsigned>(vehicleFlags()[said.code].tautline);
  });
  return static_cast<std::uint8_t>(bits);
}

void TautlineEmulator::sendSensors() noexcept {
  const SensorReadings s = plant_.readSensors();
  const Vehicle& vehicle = plant_.vehicle();
  if (!s.encoder_silent)
    send(bus::kReelId, field(static_cast<double>(s.counts), 1.0, 0, 24, true) |
                           field(plant_.reel().rate(), bus::kSpeedUnit, 24, 14, true) |
                           field(plant_.truth().reel_tension, bus::kTensionUnit, 38, 14, false));
  if (!s.angles_silent)
    send(bus::kAnglesId, field(s.tangent.elevation, bus::kAngleUnit, 0, 16, true) |
                             field(wrapped(s.tangent.azimuth), bus::kAngleUnit, 16, 16, true));
  const Eigen::Quaterniond& q = s.attitude;
  std::uint64_t bits = 0;
  unsigned start = 0;
  for (const double part : {q.w(), q.x(), q.y(), q.z()}) {
    bits |= field(part, bus::kQuaternionUnit, start, 13, true);
    start += 13;
  }
  if (!s.attitude_silent) send(bus::kAttitudeId, bits);
  send(bus::kVehicleId,
       field(static_cast<double>(static_cast<int>(flightMode())), 1.0, 0, 4, false) |
           field(flags(), 1.0, 4, 8, false) |
           field(plant_.batteryVoltage(), bus::kVoltageUnit, 12, 10, false) |
           field(vehicle.gimbalPitch(), bus::kGimbalUnit, 22, 9, true));
}

void TautlineEmulator::send(std::uint16_t id, std::uint64_t bits) noexcept {
  unsigned& alive = alive_[id == bus::kReelId       ? 0
                           : id == bus::kAnglesId   ? 1
                           : id == bus::kAttitudeId ? 2
                                                    : 3];
  TautlineFrame frame;
  frame.id = id;
  frame.size = bus::kMaxData;
  bits |= std::uint64_t{alive} << 52U;
  alive = (alive + 1) % bus::kAliveModulus;
  for (std::size_t i = 0; i + 1 < frame.size; ++i)
    frame.data[i] = static_cast<std::uint8_t>(bits >> (8 * i));
  frame.data[7] = checksum(frame, 7);
  if (head_ - tail_ == kQueue) ++tail_;
  queue_[head_++ % kQueue] = frame;
}

bool TautlineEmulator::transmit(TautlineFrame& out) noexcept {
  if (head_ == tail_) return false;
  out = queue_[tail_++ % kQueue];
  return true;
}

}  // namespace tautline::sim
