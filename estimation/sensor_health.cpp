#include "estimation/sensor_health.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
  last_update_.reset();
  health_ = {};
}

template <class T>
void SensorMonitor::check(SensorStream stream, Time now, const Sample<T>& sample,
                          bool plausible) noexcept {
  Stream& s = streams_[static_cast<std::size_t>(stream)];
  StreamHealth& health = health_.streams[static_cast<std::size_t>(stream)];
  if (sample.sequence != s.sequence) {
    s.sequence = sample.sequence;
    s.last_bad = !sample.valid || !plausible;
    if (!s.last_bad) {
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
}

bool SensorMonitor::isStuck(Motion& motion, double reading, double commanded_step,
                            double limit) noexcept {
  if (reading != motion.reading) motion = {.reading = reading, .commanded = 0.0};
  motion.commanded += commanded_step;
  return std::abs(motion.commanded) > limit;
}

const SensorHealth& SensorMonitor::update(Time now, const SensorFrame& frame,
                                          const VehicleCommand& command) noexcept {
  check(SensorStream::kReel, now, frame.reel, isPlausible(frame.reel.value, config_.max_length_m));
  check(SensorStream::kAngles, now, frame.angles, isPlausible(frame.angles.value));
  check(SensorStream::kAttitude, now, frame.attitude, isPlausible(frame.attitude.value));
  check(SensorStream::kVehicle, now, frame.vehicle, true);

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
