#include "estimation/sensor_health.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "common/tether_geometry.h"

namespace tautline {
namespace {

constexpr std::uint8_t bit(SensorFault fault) noexcept { return static_cast<std::uint8_t>(fault); }

// Above this elevation a vehicle that is told to go on rising stops by itself: its set-point ends
// at 89.5 deg.
constexpr double kSteep = 85.0 * std::numbers::pi / 180.0;

}  // namespace

bool isPlausible(const ReelReading& reading, double max_length) noexcept {
  return std::isfinite(reading.length) && reading.length >= 0.0 && reading.length <= max_length &&
         (!reading.tension || (std::isfinite(*reading.tension) && *reading.tension >= 0.0));
}

bool isPlausible(const TetherAngles& reading) noexcept {
  constexpr double kHalfPi =
      std::numbers::pi / 2.0 + 1e-9;  // a sensor's own conversion may round up
  constexpr double kTurns = 1e3;      // any branch of phi, but no nonsense
  return std::abs(reading.theta) <= kHalfPi && std::abs(reading.phi) <= kTurns &&
         (!reading.altitude || std::isfinite(*reading.altitude));
}

bool isPlausible(const AttitudeReading& reading) noexcept {
  const double norm = reading.R_WB.norm();
  return norm > 0.9 && norm < 1.1;
}

std::uint32_t SensorHealth::bits() const noexcept {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    word |= static_cast<std::uint32_t>(streams[i].faults) << (4 * i);
  }
  return word;
}

SensorMonitor::SensorMonitor(const SensorHealthConfig& config) noexcept : config_(config) {
  reset();
}

void SensorMonitor::reset() noexcept {
  streams_.fill(Stream{.period = config_.initial_period_s});
  length_ = theta_ = phi_ = Motion{};
  last_length_.reset();
  last_direction_.reset();
  last_update_.reset();
  health_ = {};
}

template <class T>
std::optional<double> SensorMonitor::check(SensorStream stream, Time now, const Sample<T>& sample,
                                           bool plausible) noexcept {
  Stream& s = streams_[static_cast<std::size_t>(stream)];
  StreamHealth& health = health_.streams[static_cast<std::size_t>(stream)];
  std::optional<double> since;
  if (sample.sequence != s.sequence) {
    s.sequence = sample.sequence;
    s.last_bad = !sample.valid || !plausible;
    if (!s.last_bad) {
      since = s.seen ? std::max(0.0, toSeconds(sample.time - s.time)) : 0.0;
      if (s.seen && sample.time > s.time) {
        // An outage must not teach a longer period than the stream has: grow slowly.
        const double interval = std::min(toSeconds(sample.time - s.time), 2.0 * s.period);
        constexpr double kLearning = 0.2;
        s.period += kLearning * (interval - s.period);
      }
      s.time = s.seen ? std::max(s.time, sample.time) : sample.time;
      s.seen = true;
    }
  }
  health.age = s.seen ? std::max(0.0, toSeconds(now - s.time)) : 0.0;
  health.period = s.period;
  health.stale_after = std::min(config_.stale_max_s,
                                std::max(config_.stale_min_s, config_.stale_periods * s.period));
  health.faults = 0;
  if (!s.seen) health.faults |= bit(SensorFault::kMissing);
  if (s.seen && health.age > health.stale_after) health.faults |= bit(SensorFault::kStale);
  if (s.last_bad) health.faults |= bit(SensorFault::kRange);
  return since;
}

void SensorMonitor::watchSteps(const SensorFrame& frame, std::optional<double> since_reel,
                               std::optional<double> since_angles) noexcept {
  const JumpConfig& jump = config_.jump;
  if (since_reel) {
    StreamHealth& reel = health_.streams[static_cast<std::size_t>(SensorStream::kReel)];
    const double length = frame.reel.value.length;
    reel.step = std::abs(length - last_length_.value_or(length));
    reel.step_allowed =
        jump.length_noise_m + jump.length_rate_mps * (*since_reel + jump.time_jitter_s);
    last_length_ = length;
  }
  StreamHealth& angles = health_.streams[static_cast<std::size_t>(SensorStream::kAngles)];
  // A parked tether lies slack and its end may point anywhere.
  if (!isFlying(frame)) {
    last_direction_.reset();
    angles.step = 0.0;
  } else if (since_angles) {
    const Eigen::Vector3d now =
        toCartesian({1.0, frame.angles.value.theta, frame.angles.value.phi});
    const Eigen::Vector3d before = last_direction_.value_or(now);
    angles.step = std::atan2(before.cross(now).norm(), before.dot(now));
    angles.step_allowed =
        jump.angle_noise_rad + jump.angle_rate_radps * (*since_angles + jump.time_jitter_s);
    last_direction_ = now;
  }
}

bool SensorMonitor::isStuck(Motion& motion, double reading, double commanded_step,
                            double limit) noexcept {
  if (reading != motion.reading) motion = {.reading = reading, .commanded = 0.0};
  motion.commanded += commanded_step;
  return std::abs(motion.commanded) > limit;
}

const SensorHealth& SensorMonitor::update(Time now, const SensorFrame& frame,
                                          const VehicleCommand& command) noexcept {
  const auto since_reel = check(SensorStream::kReel, now, frame.reel,
                                isPlausible(frame.reel.value, config_.max_length_m));
  const auto since_angles =
      check(SensorStream::kAngles, now, frame.angles, isPlausible(frame.angles.value));
  static_cast<void>(
      check(SensorStream::kAttitude, now, frame.attitude, isPlausible(frame.attitude.value)));
  static_cast<void>(check(SensorStream::kVehicle, now, frame.vehicle, true));
  watchSteps(frame, since_reel, since_angles);

  const double dt = last_update_ && now > *last_update_ ? toSeconds(now - *last_update_) : 0.0;
  last_update_ = now;
  const bool moving =
      command.engaged && frame.vehicle.valid && frame.vehicle.value.phase == VehiclePhase::kFlying;
  const auto step = [&](double rate) { return moving && std::isfinite(rate) ? rate * dt : 0.0; };
  const double theta = frame.angles.value.theta;
  const double phi = frame.angles.value.phi;
  const bool steep = std::abs(theta) > kSteep;
  if (isStuck(length_, frame.reel.value.length, step(command.length_rate),
              config_.stuck_length_m)) {
    health_.streams[static_cast<std::size_t>(SensorStream::kReel)].faults |=
        bit(SensorFault::kStuck);
  }
  const bool theta_stuck =
      isStuck(theta_, theta, steep ? 0.0 : step(command.elevation_rate), config_.stuck_angle_rad);
  const bool phi_stuck =
      isStuck(phi_, phi, steep ? 0.0 : step(command.azimuth_rate), config_.stuck_angle_rad);
  if (theta_stuck || phi_stuck) {
    health_.streams[static_cast<std::size_t>(SensorStream::kAngles)].faults |=
        bit(SensorFault::kStuck);
  }
  return health_;
}

}  // namespace tautline
