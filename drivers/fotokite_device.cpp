#include "drivers/fotokite_device.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "common/tether_geometry.h"

namespace tautline {
namespace {

using fotokite::FlightMode;
using fotokite::LineError;
using fotokite::LineKind;

constexpr double kHalfPi = std::numbers::pi / 2.0;
constexpr int kReadsPerCycle =
    8;  // bounds the work of one cycle; 4 KiB are 0.35 s of a full 115200 baud line

// Axes of a frame with x forward and z as `z_axis`, in one with x forward and y up (both
// right-handed).
Eigen::Quaterniond turnedUpright(VerticalAxis z_axis) {
  const double quarter_turn = z_axis == VerticalAxis::kDown ? kHalfPi : -kHalfPi;
  return Eigen::Quaterniond(Eigen::AngleAxisd(quarter_turn, Eigen::Vector3d::UnitX()));
}

Eigen::Quaterniond unit(const fotokite::Quaternion& q) noexcept {
  return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
}

VehiclePhase phaseOf(std::uint8_t flight_mode) noexcept {
  switch (static_cast<FlightMode>(flight_mode)) {
    case FlightMode::kIdle:
      return VehiclePhase::kIdle;
    case FlightMode::kAngle:
    case FlightMode::kAngleRate:
      return VehiclePhase::kFlying;
    case FlightMode::kEmergencyLand:
      return VehiclePhase::kLanding;
    case FlightMode::kMotorStopRestart:
    case FlightMode::kMotorStopDisable:
      return VehiclePhase::kStopped;
    case FlightMode::kTimeout:
    case FlightMode::kBatteryTooLow:
    case FlightMode::kNoTetherPower:
    case FlightMode::kHardKill:
      return VehiclePhase::kFault;
    case FlightMode::kMotorLowLevel:  // a maintenance mode: says nothing about being in the air
      break;
  }
  return VehiclePhase::kUnknown;
}

// A line that arrived whole and says something impossible: the sensor, not the link, is at fault.
void invalidate(LineKind kind, SensorFrame& frame) noexcept {
  switch (kind) {
    case LineKind::kGroundStatus:
      frame.reel.valid = false;
      frame.ground.valid = false;
      break;
    case LineKind::kAttitude:
      frame.attitude.valid = false;
      break;
    case LineKind::kGimbal:
      frame.gimbal.valid = false;
      break;
    case LineKind::kPosition:
      frame.angles.valid = false;
      break;
    case LineKind::kFlightStatus:
      frame.vehicle.valid = false;
      break;
    case LineKind::kParam:
    case LineKind::kUnknown:
      break;
  }
}

}  // namespace

FotokiteDevice::FotokiteDevice(BytePort& port, const FotokiteConfig& config)
    : port_(port),
      config_(config),
      R_WI_(Eigen::AngleAxisd(config.azimuth_offset_rad, Eigen::Vector3d::UnitY()) *
            turnedUpright(config.attitude_z)),
      R_VB_(turnedUpright(config.attitude_z).conjugate()),
      z_sign_(config.attitude_z == VerticalAxis::kUp ? 1.0 : -1.0),
      counts_per_metre_((config.invert_length ? -1.0 : 1.0) / config.length_scale_m_per_count),
      command_period_(fromSeconds(1.0 / config.command_rate_hz)) {}

void FotokiteDevice::read(Time now, SensorFrame& frame) noexcept {
  port_.poll(now);
  const std::uint32_t reconnects = port_.counters().reconnects;
  if (port_.connected() && (!was_connected_ || reconnects != reconnects_seen_)) restart();
  was_connected_ = port_.connected();
  reconnects_seen_ = reconnects;

  std::array<std::uint8_t, 512> buffer;
  for (int i = 0; i < kReadsPerCycle; ++i) {
    const ReadResult got = port_.read(buffer);
    if (got.count == 0) break;
    text_bytes_ += countText(std::span(buffer.data(), got.count));
    assembler_.push(std::span(buffer.data(), got.count),
                    [&](std::string_view text, LineError error) {
                      if (error == LineError::kNone) {
                        accept(now, fotokite::parseTelemetry(text), frame);
                      } else {
                        lines_.count(error);
                      }
                    });
  }
  const LinkFault heard = monitor_.update(now, {.connected = port_.connected(),
                                                .bytes = port_.counters().bytes_in,
                                                .text_bytes = text_bytes_,
                                                .good = lines_.good(),
                                                .bad = lines_.bad()});
  fault_ = port_.connected() ? heard : port_.fault();
  frame.link = status();
}

void FotokiteDevice::accept(Time now, const fotokite::ParsedLine& line,
                            SensorFrame& frame) noexcept {
  lines_.count(line.error);
  if (line.error == LineError::kOutOfRange) invalidate(line.kind, frame);
  if (line.error != LineError::kNone) return;
  last_telemetry_ = now;

  if (const auto* ground = std::get_if<fotokite::GroundStatus>(&line.value)) {
    acceptGround(now, *ground, frame);
  } else if (const auto* attitude = std::get_if<fotokite::Attitude>(&line.value)) {
    update(frame.attitude, now, AttitudeReading{.R_WB = R_WI_ * unit(attitude->q) * R_VB_});
  } else if (const auto* gimbal = std::get_if<fotokite::Gimbal>(&line.value)) {
    const Eigen::Vector3d view_W = R_WI_ * (unit(gimbal->q) * Eigen::Vector3d::UnitX());
    update(frame.gimbal, now, GimbalReading{.pitch = std::asin(std::clamp(view_W.y(), -1.0, 1.0))});
  } else if (const auto* position = std::get_if<fotokite::Position>(&line.value)) {
    const double theta =
        std::clamp(kHalfPi - position->elevation_from_vertical + config_.elevation_offset_rad,
                   -kHalfPi, kHalfPi);
    const double phi = wrapAngle(position->azimuth + kHalfPi + config_.azimuth_offset_rad);
    update(frame.angles, now,
           TetherAngles{.theta = theta, .phi = phi, .altitude = position->altitude});
  } else if (const auto* flight = std::get_if<fotokite::FlightStatus>(&line.value)) {
    update(frame.vehicle, now,
           VehicleReading{.phase = phaseOf(flight->mode),
                          .flight_mode = flight->mode,
                          .flags = flight->flags,
                          .backup_battery_voltage = flight->backup_battery_voltage,
                          .protocol = VehicleProtocol::kFotokite});
  }
}

void FotokiteDevice::acceptGround(Time now, const fotokite::GroundStatus& ground,
                                  SensorFrame& frame) noexcept {
  const double length = ground.length_counts / counts_per_metre_ + config_.length_offset_m;
  update(frame.reel, now,
         ReelReading{.counts = ground.length_counts,
                     .length = std::max(0.0, length),
                     .tension = std::nullopt});
  update(frame.ground, now,
         GroundReading{.mode = ground.mode, .battery_voltage = ground.battery_voltage});

  if (ground.mode == static_cast<std::uint8_t>(fotokite::GroundMode::kRemoteControlled)) {
    not_remote_since_.reset();
  } else if (started() && !not_remote_since_) {
    not_remote_since_ = now;
  }
}

void FotokiteDevice::restart() noexcept {
  assembler_.reset();
  start_step_ = 0;
  start_pace_.reset();
  last_telemetry_.reset();
  not_remote_since_.reset();
  sent_ = Rates{};
  rates_pace_.reset();
  gimbal_pace_.reset();
  tether_controller_.reset();
}

bool FotokiteDevice::lostRemoteControl(Time now) const noexcept {
  return (not_remote_since_ && now - *not_remote_since_ > kRemoteControlTimeout) ||
         (last_telemetry_ && now - *last_telemetry_ > kSilenceTimeout);
}

void FotokiteDevice::write(Time now, const VehicleCommand& command) noexcept {
  if (!port_.connected()) return;
  const bool allowed = command.engaged || command.action == VehicleAction::kMotorStop;
  sendAction(now, allowed ? command.action : VehicleAction::kNone);
  if (started() && lostRemoteControl(now)) restart();
  if (!started()) {
    sendStartLine(now);
    return;
  }
  if (command.engaged) sendTetherController(command.reel_controller);
  sendRates(now, command.engaged ? toDevice(command) : Rates{});
}

void FotokiteDevice::shutdown(Time now) noexcept {
  rates_pace_.reset();
  gimbal_pace_.reset();
  sendRates(now, Rates{});
  send(fotokite::formatLine(fotokite::kStopCommand));
  port_.poll(now);
}

fotokite::Command FotokiteDevice::startLine(std::size_t step) const noexcept {
  using namespace fotokite;
  if (step < kStartRemoteControl.size()) return formatLine(kStartRemoteControl[step]);
  step -= kStartRemoteControl.size();
  if (step < kParameterLines) {
    if (step == 0) return formatSetParameter(kTelemetryRateParameter, config_.telemetry_rate_hz);
    if (step == 2) return formatSetParameter(kDebugParameter, 0);
    return formatLine(kCommitCommand);
  }
  return formatLine(kSubscribe[step - kParameterLines]);
}

void FotokiteDevice::sendStartLine(Time now) noexcept {
  if (!start_pace_.due(now)) return;
  send(startLine(start_step_));
  start_pace_.done(now, kStartLineInterval);
  ++start_step_;
  if (started()) last_telemetry_ = now;
}

void FotokiteDevice::sendAction(Time now, VehicleAction action) noexcept {
  const bool changed = action != sent_action_;
  sent_action_ = action;
  // It has no command for a landing: rates bring it down.
  if (action == VehicleAction::kNone || action == VehicleAction::kLand) return;
  if (action == VehicleAction::kTakeoff && !started()) return;
  if (!changed && !action_pace_.due(now)) return;
  send(fotokite::formatLine(action == VehicleAction::kTakeoff ? fotokite::kTakeoffCommand
                                                              : fotokite::kMotorStopCommand));
  action_pace_.done(now, command_period_);
}

void FotokiteDevice::sendTetherController(bool on) noexcept {
  if (tether_controller_ == on) return;
  send(fotokite::formatSetParameter(fotokite::kTetherControllerParameter, on ? 1 : 0));
  send(fotokite::formatLine(fotokite::kCommitCommand));
  tether_controller_ = on;
}

void FotokiteDevice::sendRates(Time now, const Rates& rates) noexcept {
  const bool stopping = rates.zero() && rates != sent_;
  if (!stopping && !rates_pace_.due(now)) return;

  // Without engagement the reel must hold: Pos asks for no change of length, where a Pos2 rate of 0
  // is only as still as the reel's own zero.
  send(rates.hold ? fotokite::formatPos(0.0, 0.0, 0.0)
                  : fotokite::formatPos2(rates.elevation, rates.azimuth, rates.reel));
  send(fotokite::formatYaw(rates.yaw));
  rates_pace_.done(now, command_period_);
  if (rates.gimbal != sent_.gimbal || gimbal_pace_.due(now)) {
    send(fotokite::formatGimbal(rates.gimbal, 0.0));
    gimbal_pace_.done(now, kGimbalPeriod);
  }
  sent_ = rates;
}

void FotokiteDevice::send(const fotokite::Command& command) noexcept {
  port_.write(command.bytes());
}

bool FotokiteDevice::Rates::zero() const noexcept {
  return elevation == 0.0 && azimuth == 0.0 && reel == 0.0 && yaw == 0.0 && gimbal == 0.0;
}

FotokiteDevice::Rates FotokiteDevice::toDevice(const VehicleCommand& command) const noexcept {
  return {.hold = false,
          .elevation = command.elevation_rate,
          .azimuth = command.azimuth_rate,
          .reel = command.length_rate * counts_per_metre_,
          .yaw = z_sign_ * command.yaw_rate,
          .gimbal = -z_sign_ * command.gimbal_pitch_rate};
}

LinkStatus FotokiteDevice::status() const noexcept {
  const PortCounters port = port_.counters();
  return {.connected = port_.connected(),
          .bytes_in = port.bytes_in,
          .bytes_out = port.bytes_out,
          .lines_ok = lines_.good(),
          .lines_bad = lines_.bad(),
          .bytes_dropped = port.bytes_dropped,
          .reconnects = port.reconnects,
          .fault = fault_};
}

}  // namespace tautline
