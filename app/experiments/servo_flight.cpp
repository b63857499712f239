#include "app/experiments/servo_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "app/experiments/tracked_flight.h"

namespace tautline::experiments {
namespace {

constexpr std::int64_t kSession = 1;
constexpr Duration kStickPeriod = std::chrono::milliseconds(50);
constexpr double kErrorPeriod = 0.1;   // [s]
constexpr double kPhaseLimit = 120.0;  // for take-off, and for the approach [s]
constexpr double kFacing = 8.0;        // to turn to the marker once there [s]

sim::Pose markerSeenFrom(const sim::Pose& camera, const sim::Pose& marker) {
  const Eigen::Quaterniond back = camera.rotation.conjugate();
  return {back * (marker.position - camera.position), back * marker.rotation};
}

ServoError errorOf(const sim::Pose& seen, double standoff) {
  ServoError e;
  // Camera frame: x along the axis, y up, z right.
  e.translation = {seen.position.z(), -seen.position.y(), seen.position.x() - standoff};
  // A marker that is faced squarely looks back: its normal is -x.
  const Eigen::Vector3d normal = seen.rotation * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d up = seen.rotation * Eigen::Vector3d::UnitY();
  e.yaw = std::atan2(normal.z(), -normal.x());
  e.pitch = std::asin(std::clamp(normal.y(), -1.0, 1.0));
  e.roll = std::atan2(up.z(), up.y());
  return e;
}

}  // namespace

CarriedMarker::CarriedMarker(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
  };
  const auto wobble = [&](double spread) {
    Wobble w;
    constexpr int kSines = 4;
    for (int i = 0; i < kSines; ++i) {
      w.sines.push_back({spread * std::sqrt(2.0 / kSines), uniform(0.05, 0.35),
                         uniform(0.0, 2.0 * std::numbers::pi)});
    }
    return w;
  };
  turn_phase_ = uniform(0.0, 2.0 * std::numbers::pi);
  azimuth_ = wobble(0.15);
  radius_ = wobble(0.15);
  height_ = wobble(0.15);
  yaw_ = wobble(0.12);
  pitch_ = wobble(0.12);
}

double CarriedMarker::Wobble::at(double t) const {
  double sum = 0.0;
  for (const Sine& s : sines) sum += s.amplitude * std::sin(s.omega * t + s.phase);
  return sum;
}

sim::Pose CarriedMarker::at(double t) const {
  constexpr double kTurn = 2.0 * std::numbers::pi / 120.0;  // once round, through all quadrants
  const double azimuth = turn_phase_ + kTurn * t + azimuth_.at(t);
  const double radius = 2.2 + radius_.at(t);
  const Eigen::Vector3d position(radius * std::sin(azimuth), 1.1 + height_.at(t),
                                 radius * std::cos(azimuth));
  // Its face looks at the reel's axis, i.e. towards azimuth + pi.
  const double facing = azimuth + std::numbers::pi + yaw_.at(t);
  return {position, sim::cameraToWorld(facing - 0.5 * std::numbers::pi, pitch_.at(t))};
}

ServoFlight flyServo(const ServoFlightConfig& config) {
  ServoFlight flight;
  bench::Lockstep bench(config.bench, nullptr);
  sim::Camera camera(config.camera);
  sim::Random random(config.bench.seed ^ 0xCA3E8AULL);
  const CarriedMarker carried(config.bench.seed);
  VisualServo servo(config.servo);

  std::int64_t sequence = 0;
  const auto ask = [&](Request request) {
    const StepOutput& out = bench.step(OperatorCommand{kSession, ++sequence, request, 0});
    return out.ack && out.ack->result == AckResult::kAccepted;
  };
  const auto mode = [&] { return bench.output().supervision.mode; };
  const auto until = [&](Mode wanted, double seconds) {
    for (const Time end = bench.now() + fromSeconds(seconds); mode() != wanted;) {
      if (bench.now() >= end || bench.truth().crashed) return false;
      bench.step();
    }
    return true;
  };
  // The operator first brings the drone before the marker, which waits.
  const sim::Pose waiting = carried.at(0.0);
  const auto approach = missionThrough(
      {waiting.position + config.servo.standoff_m * (waiting.rotation * Eigen::Vector3d::UnitX())},
      kFacing);
  approach->waypoints[0].p_WL = waiting.position;
  const bench::MissionStart start =
      bench::beginMission(bench, *approach, bench.now() + fromSeconds(2.0 * kPhaseLimit), {});
  sequence = start.sequence;
  if (!start.navigating || !until(Mode::kHold, kPhaseLimit)) return flight;
  bench.holdSticks(Sticks{kSession, true, {}});
  if (!ask(Request::kTeleop)) return flight;

  const Time began = bench.now();
  const auto since = [&] { return toSeconds(bench.now() - began); };
  Time next_stick = began;
  double next_error = config.settle;
  std::int64_t pictures = 0;
  std::int64_t sighted = 0;
  while (since() < config.duration && !bench.truth().crashed) {
    const sim::Truth& truth = bench.truth();
    const sim::Pose eye{truth.p_WD, sim::cameraToWorld(truth.yaw, truth.gimbal_pitch)};
    const sim::Pose marker = carried.at(since());
    camera.step(bench.now(), eye, marker, random);
    if (bench.now() >= next_stick) {
      next_stick += kStickPeriod;
      const std::optional<sim::MarkerDetection> seen = camera.read(bench.now());
      ++pictures;
      sighted += seen ? 1 : 0;
      const StepOutput& state = bench.output();
      const SensorFrame& sensors = bench.sensors();
      ServoInput in{.estimate = state.estimate,
                    .anchor = state.anchor,
                    .limits = config.bench.station.core.limits};
      if (sensors.attitude.valid) in.R_WB = sensors.attitude.value.R_WB;
      if (sensors.gimbal.valid) in.gimbal_pitch = sensors.gimbal.value.pitch;
      if (seen) {
        in.sighting = Sighting{seen->taken, seen->marker.position,
                               seen->marker.rotation * Eigen::Vector3d::UnitX()};
      }
      bench.holdSticks(Sticks{kSession, true, servo.update(bench.now(), in)});
    }
    bench.step();
    if (mode() != Mode::kTeleop) return flight;
    if (since() < next_error) continue;
    next_error += kErrorPeriod;
    const sim::Truth& now = bench.truth();
    const sim::Pose where{now.p_WD, sim::cameraToWorld(now.yaw, now.gimbal_pitch)};
    const sim::Pose carried_now = carried.at(since());
    ServoError error = errorOf(markerSeenFrom(where, carried_now), config.servo.standoff_m);
    error.t = since();
    error.p_WD = now.p_WD;
    error.p_WM = carried_now.position;
    flight.errors.push_back(error);
  }
  flight.crash = bench.truth().crash_reason;
  flight.servoed = !bench.truth().crashed;
  flight.in_sight =
      pictures > 0 ? static_cast<double>(sighted) / static_cast<double>(pictures) : 0.0;
  return flight;
}

}  // namespace tautline::experiments
