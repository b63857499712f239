#include "drivers/tautline_device.h"

#include <algorithm>
#include <cmath>

#include "common/tether_geometry.h"

namespace tautline {
namespace {

using bus::BusMode;
using bus::EndToEnd;
using bus::MessageError;

constexpr Duration kMessageTimeout = bus::kTimeoutPeriods * bus::kSensorPeriod;
constexpr Duration kOtherStationShown = std::chrono::seconds(2);

/// Index of a sensor's message, or nothing for what only stations send.
std::optional<std::size_t> streamOf(std::uint16_t id) noexcept {
  switch (id) {
    case bus::kReelId:
      return 0;
    case bus::kAnglesId:
      return 1;
    case bus::kAttitudeId:
      return 2;
    case bus::kVehicleId:
      return 3;
    default:
      return std::nullopt;
  }
}

VehiclePhase phaseOf(bus::FlightMode mode) noexcept {
  switch (mode) {
    case bus::FlightMode::kIdle:
      return VehiclePhase::kIdle;
    case bus::FlightMode::kFlying:
      return VehiclePhase::kFlying;
    case bus::FlightMode::kLanding:
      return VehiclePhase::kLanding;
    case bus::FlightMode::kStopped:
      return VehiclePhase::kStopped;
    case bus::FlightMode::kFault:
      return VehiclePhase::kFault;
  }
  return VehiclePhase::kUnknown;
}

/// The message arrived whole and says something impossible: the sensor is at fault, not the link.
void invalidate(std::uint16_t id, SensorFrame& frame) noexcept {
  if (id == bus::kReelId) frame.reel.valid = false;
  if (id == bus::kAnglesId) frame.angles.valid = false;
  if (id == bus::kAttitudeId) frame.attitude.valid = false;
  if (id == bus::kVehicleId) frame.vehicle.valid = frame.gimbal.valid = frame.ground.valid = false;
}

bool operator==(const bus::ModeCommand& a, const bus::ModeCommand& b) noexcept {
  return a.mode == b.mode && a.reel_controller == b.reel_controller &&
         a.gimbal_pitch == b.gimbal_pitch && a.gimbal_roll == b.gimbal_roll;
}

bool isRest(const bus::Rates& r) noexcept {
  return r.length == 0.0 && r.elevation == 0.0 && r.azimuth == 0.0 && r.yaw == 0.0;
}

bus::Rates ratesOf(const VehicleCommand& c) noexcept {
  if (!c.engaged) return {};
  return {c.length_rate, c.elevation_rate, c.azimuth_rate, c.yaw_rate};
}

BusMode modeOf(VehicleAction action) noexcept {
  switch (action) {
    case VehicleAction::kTakeoff:
      return BusMode::kTakeoff;
    case VehicleAction::kLand:
      return BusMode::kLand;
    case VehicleAction::kMotorStop:
      return BusMode::kStop;
    case VehicleAction::kNone:
      break;
  }
  return BusMode::kArmed;
}

bus::ModeCommand modeOf(const VehicleCommand& c) noexcept {
  if (!c.engaged) return {};
  return {modeOf(c.action), c.reel_controller, c.gimbal_pitch_rate, 0.0};
}

}  // namespace

TautlineDevice::TautlineDevice(FramePort& port, const TautlineConfig& config, const char* name)
    : port_(port),
      config_(config),
      name_(name),
      R_WV_(Eigen::AngleAxisd(config.azimuth_offset_rad, Eigen::Vector3d::UnitY())),
      rates_period_(fromSeconds(1.0 / config.command_rate_hz)) {
  static_cast<void>(bus::parse(bus::encode(bus::Rates{}, 0)));  // the CRC's table is made here
}

void TautlineDevice::read(Time now, SensorFrame& frame) noexcept {
  port_.poll(now);
  const std::uint32_t reconnects = port_.counters().reconnects;
  if (port_.connected() && (!was_connected_ || reconnects != reconnects_seen_)) restart();
  was_connected_ = port_.connected();
  reconnects_seen_ = reconnects;

  BusFrame message;
  while (port_.read(message)) accept(now, message, frame);  // the port bounds it
  for (Stream& stream : streams_)
    timeouts_ += stream.check.timedOut(now, kMessageTimeout) ? 1U : 0U;
  watch(now);
  frame.link = status();
}

void TautlineDevice::accept(Time now, const BusFrame& message, SensorFrame& frame) noexcept {
  const bus::Parsed parsed = bus::parse(message);
  const std::optional<std::size_t> index = streamOf(message.id);
  if (!index) {
    if (parsed.error == MessageError::kNone) {
      other_station_ = now;
    } else {
      ++unknown_;
    }
    return;
  }
  Stream& stream = streams_[*index];
  const EndToEnd result = stream.check.check(now, parsed);
  ++results_[static_cast<std::size_t>(result)];
  ++(result == EndToEnd::kOk ? stream.used : stream.refused);
  if (parsed.error == MessageError::kOutOfRange) invalidate(message.id, frame);
  if (result == EndToEnd::kOk) use(message, parsed, frame);
}

void TautlineDevice::use(const BusFrame& message, const bus::Parsed& parsed,
                         SensorFrame& frame) noexcept {
  const Time time = message.time;
  if (const auto* reel = std::get_if<bus::Reel>(&parsed.value)) {
    const double length =
        reel->counts * bus::kCountUnit * config_.length_scale + config_.length_offset_m;
    update(frame.reel, time,
           ReelReading{.counts = static_cast<double>(reel->counts),
                       .length = std::max(0.0, length),
                       .tension = reel->tension});
  } else if (const auto* angles = std::get_if<bus::Angles>(&parsed.value)) {
    update(frame.angles, time,
           TetherAngles{.theta = angles->elevation,
                        .phi = wrapAngle(angles->azimuth + config_.azimuth_offset_rad),
                        .altitude = std::nullopt});
    frame.angles.valid = angles->status == bus::SensorStatus::kGood;
  } else if (const auto* q = std::get_if<bus::Attitude>(&parsed.value)) {
    const Eigen::Quaterniond R_VB = Eigen::Quaterniond(q->w, q->x, q->y, q->z).normalized();
    update(frame.attitude, time, AttitudeReading{.R_WB = R_WV_ * R_VB});
  } else if (const auto* vehicle = std::get_if<bus::VehicleStatus>(&parsed.value)) {
    update(frame.vehicle, time,
           VehicleReading{.phase = phaseOf(vehicle->mode),
                          .flight_mode = static_cast<std::uint8_t>(vehicle->mode),
                          .flags = vehicle->flags,
                          .backup_battery_voltage = 0.0,
                          .protocol = VehicleProtocol::kTautline});
    update(frame.gimbal, time, GimbalReading{.pitch = vehicle->gimbal_pitch});
    update(frame.ground, time,
           GroundReading{.mode = 0, .battery_voltage = vehicle->battery_voltage});
  }
}

/// Names what is wrong, the most telling first.
void TautlineDevice::watch(Time now) noexcept {
  judgeStreams(now);
  const PortCounters port = port_.counters();
  const FrameCounters frames = port_.frameCounters();
  const std::uint32_t good = messages(EndToEnd::kOk);
  std::uint32_t bad = frames.frames_bad + unknown_;
  for (const EndToEnd r : {EndToEnd::kRepeated, EndToEnd::kWrongSequence, EndToEnd::kError})
    bad += messages(r);
  const LinkFault heard = monitor_.update(now, {.connected = port_.connected(),
                                                .bytes = port.bytes_in,
                                                .text_bytes = port_.textBytes(),
                                                .good = good,
                                                .bad = bad,
                                                .foreign = frames.frames_foreign + unknown_});
  const bool other = other_station_ && now - *other_station_ < kOtherStationShown;
  fault_ = port_.fault();
  if (fault_ == LinkFault::kNone && other) fault_ = LinkFault::kAnotherStation;
  if (fault_ == LinkFault::kNone) fault_ = heard;
  if (fault_ == LinkFault::kNone) fault_ = stream_fault_;
}

/// Once a window, each sensor for itself. A fault counts when two windows in a row have it: the
/// first and the last window of a sensor that comes or goes are not whole.
void TautlineDevice::judgeStreams(Time now) noexcept {
  const Duration window = now - window_start_;
  if (window < kMonitorWindow) return;
  const double expected = toSeconds(window) / toSeconds(bus::kSensorPeriod);
  const bool whole = window < 2 * kMonitorWindow;  // not the first, nor of a loop that stood still
  stream_fault_ = LinkFault::kNone;
  for (Stream& stream : streams_) {
    const LinkFault before = stream.fault;
    stream.fault = whole ? judge(stream, expected) : LinkFault::kNone;
    stream.used_before = stream.used;
    stream.refused_before = stream.refused;
    if (stream.fault != LinkFault::kNone && stream.fault == before) stream_fault_ = stream.fault;
  }
  window_start_ = now;
}

LinkFault TautlineDevice::judge(const Stream& stream, double expected) noexcept {
  const std::uint32_t used = stream.used - stream.used_before;
  const std::uint32_t refused = stream.refused - stream.refused_before;
  if (used + refused == 0) return LinkFault::kNone;  // its age tells
  if (refused >= used) return LinkFault::kUnreliable;
  const double got = used + refused;
  const bool right = got * kRateTolerance > expected && got < expected * kRateTolerance;
  return right ? LinkFault::kNone : LinkFault::kSensorRate;
}

void TautlineDevice::restart() noexcept {
  for (Stream& stream : streams_) {
    stream.check.reset();
    stream.fault = LinkFault::kNone;
  }
  rates_pace_.reset();
  mode_pace_.reset();
  sent_mode_.reset();
  window_start_ = Time{};
  stream_fault_ = LinkFault::kNone;
}

void TautlineDevice::write(Time now, const VehicleCommand& command) noexcept {
  owes_stop_ = owes_stop_ || command.action == VehicleAction::kMotorStop;
  if (!port_.connected()) return;
  bus::ModeCommand mode = modeOf(command);
  if (owes_stop_) mode.mode = BusMode::kStop;
  sendMode(now, mode);
  const bus::Rates rates = ratesOf(command);
  const bool stopping = isRest(rates) && !isRest(sent_rates_);
  if (!stopping && !rates_pace_.due(now)) return;
  if (sendRates(rates)) rates_pace_.done(now, rates_period_);
}

bool TautlineDevice::sendRates(const bus::Rates& rates) noexcept {
  if (!port_.write(bus::encode(rates, rates_alive_))) return false;
  rates_alive_ = static_cast<std::uint8_t>((rates_alive_ + 1U) % bus::kAliveModulus);
  sent_rates_ = rates;
  return true;
}

void TautlineDevice::sendMode(Time now, const bus::ModeCommand& mode) noexcept {
  const bool changed = !sent_mode_ || !(*sent_mode_ == mode);
  if (!changed && !mode_pace_.due(now)) return;
  if (!port_.write(bus::encode(mode, mode_alive_))) return;  // again in the next cycle
  mode_alive_ = static_cast<std::uint8_t>((mode_alive_ + 1U) % bus::kAliveModulus);
  sent_mode_ = mode;
  mode_pace_.done(now, bus::kModePeriod);
  if (mode.mode == BusMode::kStop) owes_stop_ = false;
}

void TautlineDevice::shutdown(Time now) noexcept {
  static_cast<void>(sendRates(bus::Rates{}));
  mode_pace_.reset();
  sendMode(now, bus::ModeCommand{});
  port_.poll(now);
}

LinkStatus TautlineDevice::status() const noexcept {
  const PortCounters port = port_.counters();
  const FrameCounters frames = port_.frameCounters();
  const std::uint32_t repeated = messages(EndToEnd::kRepeated);
  const std::uint32_t wrong_sequence = messages(EndToEnd::kWrongSequence);
  const std::uint32_t errors = messages(EndToEnd::kError);
  return {.connected = port_.connected(),
          .bytes_in = port.bytes_in,
          .bytes_out = port.bytes_out,
          .lines_ok = messages(EndToEnd::kOk),
          .lines_bad = frames.frames_bad + unknown_ + repeated + wrong_sequence + errors,
          .bytes_dropped = port.bytes_dropped,
          .reconnects = port.reconnects,
          .fault = fault_,
          .repeated = repeated,
          .wrong_sequence = wrong_sequence,
          .check_errors = errors,
          .timeouts = timeouts_,
          .bus_errors = frames.bus_errors,
          .bus_off = frames.bus_off,
          .frames_lost = frames.frames_lost,
          .frames_foreign = frames.frames_foreign,
          .no_buffer = frames.no_buffer};
}

}  // namespace tautline
