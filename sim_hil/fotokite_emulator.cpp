#include "sim_hil/fotokite_emulator.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace tautline::sim {
namespace {

using fotokite::FlightMode;
using fotokite::GroundMode;

constexpr double kHalfPi = std::numbers::pi / 2.0;
// Of a length change by Pos, PosL [counts/s]: out of the reel's dead zone in both directions.
constexpr double kMoveRate = 110.0;
constexpr double kMoveGain = 5.0;  // slows down before the target [1/s]
constexpr double kMoveDone = 0.5;  // [counts]
constexpr Duration kSlackTime = std::chrono::milliseconds(300);
constexpr Duration kStopShown = std::chrono::seconds(2);  // mode 49 after a normal stop
constexpr double kBackupLow = 3.5;                        // [V]
constexpr int kQuaternionDecimals = 4;

/// The word up to the first blank, and the rest without leading blanks.
struct Words {
  std::string_view name;
  std::string_view rest;
};
Words split(std::string_view line) noexcept {
  const std::size_t start = line.find_first_not_of(" \t");
  if (start == std::string_view::npos) return {};
  line.remove_prefix(start);
  const std::size_t end = line.find_first_of(" \t");
  if (end == std::string_view::npos) return {line, {}};
  const std::size_t next = line.find_first_not_of(" \t", end);
  return {line.substr(0, end), next == std::string_view::npos ? "" : line.substr(next)};
}

/// Exactly one finite number, blanks round it allowed.
bool parseNumber(std::string_view text, double& value) noexcept {
  const std::size_t start = text.find_first_not_of(" \t+");
  if (start == std::string_view::npos) return false;
  text = text.substr(start, text.find_last_not_of(" \t") + 1 - start);
  const auto done = std::from_chars(text.data(), text.data() + text.size(), value);
  return done.ec == std::errc{} && done.ptr == text.data() + text.size() && std::isfinite(value);
}

double limited(double value, double limit) noexcept { return std::clamp(value, -limit, limit); }

/// World axes (y up) to the device's (x forward, z down): x_I = x_W, y_I = z_W, z_I = -y_W.
Eigen::Quaterniond toDevice(const Eigen::Quaterniond& q) noexcept {
  return {q.w(), q.x(), q.z(), -q.y()};
}

void append(TelemetryLine& line, const Eigen::Quaterniond& q) noexcept {
  for (const double part : {q.w(), q.x(), q.y(), q.z()}) line.field(part, kQuaternionDecimals);
}

}  // namespace

void FotokiteEmulator::receive(std::span<const std::uint8_t> bytes) noexcept {
  input_.push(bytes, [this](std::string_view line) { obey(line); });
}

void FotokiteEmulator::obey(std::string_view line) noexcept {
  const Words words = split(line);
  if (words.name.empty()) return;
  Fields fields;
  std::string_view rest = words.rest;
  bool numbers = !rest.empty();
  while (numbers) {
    const std::size_t comma = rest.find(',');
    if (fields.count == kMaxFields ||
        !parseNumber(rest.substr(0, comma), fields.value[fields.count])) {
      numbers = false;
      fields.count = 0;
      break;
    }
    ++fields.count;
    if (comma == std::string_view::npos) break;
    rest = rest.substr(comma + 1);
  }
  if (obeySetup(words.name, words.rest, fields)) return;
  if (ground_mode_ == GroundMode::kRemoteControlled && obeyMotion(words.name, fields)) {
    last_command_ = plant_.clock();
    return;
  }
  ++refused_lines_;
}

bool FotokiteEmulator::obeySetup(std::string_view name, std::string_view rest,
                                 const Fields& f) noexcept {
  if (name == fotokite::kStopCommand) {
    stopRemoteControl();
  } else if (name == "RemoteControl") {
    if (rest != "start") return false;
    ground_mode_ = GroundMode::kRemoteControlled;
    last_command_ = plant_.clock();
  } else if (name == fotokite::kSetParameterCommand) {
    if (f.count != 2 || pending_count_ == pending_.size()) return false;
    pending_[pending_count_++] = {static_cast<int>(limited(f.value[0], 1e6)), f.value[1]};
  } else if (name == fotokite::kCommitCommand) {
    commit();
  } else if (name == "Get_GroundStatus") {
    subscribed_.ground = true;
  } else if (name == "Get_Att") {
    subscribed_.attitude = true;
  } else if (name == "Get_Pos") {
    subscribed_.position = true;
  } else if (name == "Get_FlightStatus") {
    subscribed_.flight = true;
  } else if (name == "Get_Gimbal") {
    subscribed_.gimbal = true;
  } else if (name == fotokite::kMotorStopCommand) {
    stopMotors();  // obeyed in every ground mode
  } else {
    // Reel gains and line checksums: accepted, without effect here.
    return name == "GSLowControl" || name == "Checksum" || name == "params";
  }
  return true;
}

bool FotokiteEmulator::obeyMotion(std::string_view name, const Fields& f) noexcept {
  using namespace fotokite;
  const auto is = [&](std::string_view command, std::size_t count) {
    return name == command && f.count == count;
  };
  if (is(kPosCommand, 3)) {
    setAngles(f.value[0], f.value[1]);
    moveReel(f.value[2]);
  } else if (is(kPos2Command, 3)) {
    setAngles(f.value[0], f.value[1]);
    runReel(f.value[2]);
  } else if (is(kElevationCommand, 1)) {
    rates_.elevation = limited(f.value[0], kMaxElevationRate);
  } else if (is(kAzimuthCommand, 1)) {
    rates_.azimuth = limited(f.value[0], kMaxAzimuthRate);
  } else if (is(kLengthCommand, 1)) {
    moveReel(f.value[0]);
  } else if (is(kGimbalCommand, 2)) {
    rates_.gimbal_pitch = limited(f.value[0], kMaxGimbalRate);
    rates_.gimbal_roll = limited(f.value[1], kMaxGimbalRate);
  } else if (is(kGimbalPitchCommand, 1)) {
    rates_.gimbal_pitch = limited(f.value[0], kMaxGimbalRate);
  } else if (is(kGimbalRollCommand, 1)) {
    rates_.gimbal_roll = limited(f.value[0], kMaxGimbalRate);
  } else if (is(kYawCommand, 1)) {
    rates_.yaw = -limited(f.value[0], kMaxYawRate);  // about the device's z, down
  } else if (name == kTakeoffCommand) {
    startTakeoff();
  } else {
    return false;
  }
  plant_.vehicle().command(rates_);
  return true;
}

void FotokiteEmulator::setAngles(double elevation_rate, double azimuth_rate) noexcept {
  rates_.elevation = limited(elevation_rate, fotokite::kMaxElevationRate);
  rates_.azimuth = limited(azimuth_rate, fotokite::kMaxAzimuthRate);
}

void FotokiteEmulator::moveReel(double counts) noexcept {
  reel_target_ = static_cast<double>(plant_.reel().counts()) + counts;
  reel_mode_ = std::abs(counts) < kMoveDone ? ReelMode::kHold : ReelMode::kMove;
}

void FotokiteEmulator::runReel(double counts_per_second) noexcept {
  reel_rate_ = limited(counts_per_second, fotokite::kMaxReelRate);
  reel_mode_ = ReelMode::kRate;
}

void FotokiteEmulator::holdEverything() noexcept {
  rates_ = {};
  reel_mode_ = ReelMode::kHold;
  plant_.vehicle().command(rates_);
}

void FotokiteEmulator::startTakeoff() noexcept {
  const Truth& truth = plant_.truth();
  if (truth.crashed || !truth.on_ground || plant_.vehicle().motorsOn() || batteryTooLow()) return;
  holdEverything();
  stopped_in_air_ = false;
  low_launch_ = plant_.readSensors().tangent.elevation < config_.low_launch_angle;
  plant_.vehicle().startTakeoff();
}

void FotokiteEmulator::stopMotors() noexcept {
  if (!plant_.vehicle().motorsOn()) return;
  stopped_in_air_ = !plant_.truth().on_ground;
  holdEverything();
  plant_.vehicle().stopMotors();
}

void FotokiteEmulator::stopRemoteControl() noexcept {
  holdEverything();
  subscribed_ = {};
  commanded_rate_ = 0.0;
  ground_mode_ = GroundMode::kMenu;
}

void FotokiteEmulator::commit() noexcept {
  for (std::size_t i = 0; i < pending_count_; ++i) {
    const Parameter& p = pending_[i];
    if (p.id == fotokite::kTelemetryRateParameter) {
      commanded_rate_ = std::clamp(p.value, 0.1, config_.max_rate);
    } else if (p.id == fotokite::kTetherControllerParameter) {
      tether_controller_ = p.value != 0.0;
    }
    TelemetryLine answer(fotokite::kParamHeader);
    output_.put(answer.field(std::int64_t{p.id}).field(p.value, 2).finish());
  }
  pending_count_ = 0;
}

void FotokiteEmulator::advance() noexcept {
  const bool on = plant_.vehicle().motorsOn();
  if (was_on_ && !on) {
    motors_stopped_ = plant_.clock();
    has_flown_ = true;
  }
  was_on_ = on;
  stepTimeouts();
  stepReel();
  stepTelemetry();
}

bool FotokiteEmulator::flying() const noexcept {
  const FlightPhase phase = plant_.vehicle().phase();
  return phase == FlightPhase::kTakeoff || phase == FlightPhase::kFlying ||
         phase == FlightPhase::kEmergencyLand;
}

void FotokiteEmulator::stepTimeouts() noexcept {
  const Time now = plant_.clock();
  if (plant_.truth().tension >= config_.slack_tension || !flying()) slack_since_ = now;
  if (low_launch_ && plant_.truth().tangent_elevation >= config_.low_launch_angle) {
    low_launch_ = false;
  }
  if (!flying()) return;
  const Duration silence = now - last_command_;
  if (silence > fromSeconds(config_.command_timeout)) holdEverything();
  const bool empty = plant_.batteryVoltage() < plant_.vehicle().config().battery_empty;
  if (silence > fromSeconds(config_.landing_timeout) || empty) plant_.vehicle().emergencyLand();
}

void FotokiteEmulator::stepReel() noexcept {
  Reel& reel = plant_.reel();
  reel.lock(!tether_controller_ || reel_mode_ == ReelMode::kHold);
  if (reel_mode_ == ReelMode::kRate) {
    reel.command(reel_rate_);
  } else if (reel_mode_ == ReelMode::kMove) {
    const double left = reel_target_ - static_cast<double>(reel.counts());
    if (std::abs(left) < kMoveDone) {
      reel_mode_ = ReelMode::kHold;
      reel.lock(true);
    } else {
      reel.command(limited(kMoveGain * left, kMoveRate));
    }
  }
}

double FotokiteEmulator::telemetryRate() const noexcept {
  if (config_.forced_rate > 0.0) return config_.forced_rate;
  return commanded_rate_ > 0.0 ? commanded_rate_ : config_.default_rate;
}

FlightMode FotokiteEmulator::flightMode() const noexcept {
  const FaultSchedule& faults = plant_.faults();
  if (const Fault* said = faults.active(FaultTarget::kFlightMode, FaultMode::kOn))
    return static_cast<FlightMode>(vehicleFlightModes()[said->code].fotokite);
  if (plant_.truth().crashed) return FlightMode::kHardKill;
  switch (plant_.vehicle().phase()) {
    case FlightPhase::kTakeoff:
    case FlightPhase::kFlying:
      return FlightMode::kAngle;
    case FlightPhase::kEmergencyLand:
      return FlightMode::kEmergencyLand;
    case FlightPhase::kSpoolUp:
      return FlightMode::kIdle;
    case FlightPhase::kParked:
      break;
  }
  if (batteryTooLow()) return FlightMode::kBatteryTooLow;
  if (stopped_in_air_) return FlightMode::kMotorStopDisable;
  const bool just_stopped = has_flown_ && plant_.clock() - motors_stopped_ < kStopShown;
  return just_stopped ? FlightMode::kMotorStopRestart : FlightMode::kIdle;
}

bool FotokiteEmulator::batteryTooLow() const noexcept {
  const Vehicle& vehicle = plant_.vehicle();
  return plant_.batteryVoltage() < vehicle.config().battery_critical;
}

std::uint16_t FotokiteEmulator::flags() const noexcept {
  using namespace fotokite;
  const Vehicle& vehicle = plant_.vehicle();
  const Time now = plant_.clock();
  std::uint32_t bits = 0;
  const auto set = [&](bool condition, FlightFlag flag) {
    if (condition) bits |= flag;
  };
  set(batteryTooLow(), kCriticalBattery);
  set(plant_.batteryVoltage() < vehicle.config().battery_low, kLowBattery);
  set(vehicle.backupVoltage() < kBackupLow, kLowBackupBattery);
  set(flying() && now - last_command_ > fromSeconds(config_.command_timeout), kNoSyncCommands);
  set(vehicle.motorsOn() && low_launch_, kLowLaunchAngle);
  set(vehicle.phase() == FlightPhase::kEmergencyLand, kEmergencyLandFlag);
  set(now - slack_since_ > kSlackTime, kNoTetherDetected);
  set(plant_.truth().crashed, kHardKillFlag);
  plant_.faults().forEachActive(FaultTarget::kFlag, FaultMode::kOn, [&](const Fault& said) {
    bits |= static_cast<std::uint32_t>(vehicleFlags()[said.code].fotokite);
  });
  return static_cast<std::uint16_t>(bits);
}

void FotokiteEmulator::stepTelemetry() noexcept {
  const Time now = plant_.clock();
  const auto due = [now](Time& next, double rate) {
    if (now < next) return false;
    const Duration period = fromSeconds(1.0 / rate);
    next += period;
    if (next <= now) next = now + period;  // no burst of missed lines
    return true;
  };
  const double rate = telemetryRate();
  if (next_telemetry_ > now + fromSeconds(1.0 / rate)) next_telemetry_ = now;
  if (due(next_telemetry_, rate)) {
    const SensorReadings sensed = plant_.readSensors();
    if (subscribed_.ground && !sensed.encoder_silent) {
      TelemetryLine line(fotokite::kGroundStatusHeader);
      line.field(static_cast<std::int64_t>(ground_mode_))
          .field(toSeconds(now.time_since_epoch()), 2)
          .field(plant_.batteryVoltage(), 2)
          .field(sensed.counts);
      output_.put(line.finish());
    }
    if (subscribed_.attitude && !sensed.attitude_silent) {
      TelemetryLine line(fotokite::kAttitudeHeader);
      append(line, toDevice(sensed.attitude));
      output_.put(line.finish());
    }
    if (subscribed_.position && !sensed.angles_silent) {
      const double resolution = config_.angle_resolution;
      const int decimals = std::max(2, static_cast<int>(std::ceil(-std::log10(resolution) - 1e-9)));
      const auto rounded = [resolution](double x) {
        return std::round(x / resolution) * resolution;
      };
      TelemetryLine line(fotokite::kPositionHeader);
      line.field(rounded(kHalfPi - sensed.tangent.elevation), decimals)
          .field(rounded(wrapped(sensed.tangent.azimuth - kHalfPi)), decimals)
          .field(sensed.altitude, 2);
      output_.put(line.finish());
    }
  }
  const double status_rate = std::min(rate, config_.status_rate);
  if (next_status_ > now + fromSeconds(1.0 / status_rate)) next_status_ = now;
  if (due(next_status_, status_rate)) sendStatusLines();
}

void FotokiteEmulator::sendStatusLines() noexcept {
  const Vehicle& vehicle = plant_.vehicle();
  if (subscribed_.flight) {
    TelemetryLine line(fotokite::kFlightStatusHeader);
    line.field(static_cast<std::int64_t>(flightMode()))
        .field(toSeconds(plant_.clock().time_since_epoch()), 2)
        .field(vehicle.backupVoltage(), 2)
        .field(std::int64_t{flags()});
    output_.put(line.finish());
  }
  if (subscribed_.gimbal) {
    // Levelled by itself: heading, then pitch, then roll, in the device's axes.
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(Eigen::AngleAxisd(-vehicle.yaw(), Eigen::Vector3d::UnitZ())) *
        Eigen::Quaterniond(Eigen::AngleAxisd(vehicle.gimbalPitch(), Eigen::Vector3d::UnitY())) *
        Eigen::Quaterniond(Eigen::AngleAxisd(vehicle.gimbalRoll(), Eigen::Vector3d::UnitX()));
    TelemetryLine line(fotokite::kGimbalHeader);
    append(line, q);
    output_.put(line.finish());
  }
}

}  // namespace tautline::sim
