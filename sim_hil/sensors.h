#pragma once

/// @file
/// The device's sensors: each has its own rate, latency and errors. A reading is what the sensor
/// last delivered, never the present truth.

#include <array>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/fields.h"
#include "common/time.h"
#include "sim_hil/polar.h"
#include "sim_hil/random.h"

namespace tautline::sim {

/// When a sensor samples and how late its samples are.
struct SensorTiming {
  double rate{100.0};    ///< [Hz]
  double latency{0.01};  ///< [s]
  double jitter{0.0};    ///< Largest addition to the latency, uniform [s].

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("rate_hz", rate, Range{0.1, 1000}, "samples a second");
    v.field("latency_s", latency, Range{0, 1}, "from measurement to delivery");
    v.field("jitter_s", jitter, Range{0, 1}, "largest addition to the latency");
  }
};

struct SensorConfig {
  SensorTiming encoder{100.0, 0.005, 0.0};
  SensorTiming angles{100.0, 0.02, 0.005};
  SensorTiming attitude{100.0, 0.01, 0.005};
  SensorTiming barometer{25.0, 0.05, 0.0};
  double angle_noise{0.005};     ///< Of the tether's direction, isotropic [rad].
  double elevation_bias{0.0};    ///< Sensed minus true [rad].
  double azimuth_bias{0.0};      ///< Sensed minus true; also a turned initialization frame [rad].
  double attitude_noise{0.005};  ///< Each axis [rad].
  double barometer_noise{0.1};   ///< [m]
  double barometer_bias{0.0};    ///< [m]

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("angle_noise_rad", angle_noise, Range{0, 0.5}, "of the tether's direction, isotropic");
    v.field("elevation_bias_rad", elevation_bias, Range{-0.5, 0.5}, "sensed minus true");
    v.field("azimuth_bias_rad", azimuth_bias, Range{-3.2, 3.2}, "sensed minus true");
    v.field("attitude_noise_rad", attitude_noise, Range{0, 0.5}, "each axis");
    v.field("barometer_noise_m", barometer_noise, Range{0, 10}, "standard deviation");
    v.field("barometer_bias_m", barometer_bias, Range{-100, 100}, "constant");
    v.section("encoder", encoder);
    v.section("angles", angles);
    v.section("attitude", attitude);
    v.section("barometer", barometer);
  }
};

/// What a sensor could see in this instant, without errors.
struct SensorInput {
  std::int64_t counts{0};
  Polar tangent;
  Eigen::Quaterniond attitude{Eigen::Quaterniond::Identity()};
  double altitude{0.0};  ///< Above the start [m].
};

/// What the sensors have delivered.
struct SensorReadings {
  std::int64_t counts{0};
  Polar tangent;
  Eigen::Quaterniond attitude{Eigen::Quaterniond::Identity()};
  double altitude{0.0};
  /// @name Sensors whose telegram is not sent
  /// @{
  bool encoder_silent{false};
  bool angles_silent{false};
  bool attitude_silent{false};
  /// @}
};

/// Samples on their way from the sensor to its reader. Holds the last kCapacity; at rate x latency
/// beyond that the oldest are lost, so that the reading comes late but never too early.
template <class T>
class DelayLine {
 public:
  DelayLine(const SensorTiming& timing, const T& initial) noexcept
      : timing_(timing), delivered_(initial) {}

  [[nodiscard]] bool due(Time now) const noexcept { return now >= next_sample_; }

  void sample(Time now, const T& value, Random& random) noexcept {
    next_sample_ = std::max(next_sample_, now - period()) + period();
    Duration delay = fromSeconds(timing_.latency);
    if (timing_.jitter > 0.0) {
      delay += fromSeconds(timing_.jitter * 0.5 * (1.0 + random.signedUniform()));
    }
    entries_[head_ % kCapacity] = {now + delay, value};
    ++head_;
    if (head_ - tail_ > kCapacity) tail_ = head_ - kCapacity;
  }

  const T& read(Time now) noexcept {
    while (tail_ != head_ && entries_[tail_ % kCapacity].delivery <= now) {
      delivered_ = entries_[tail_ % kCapacity].value;
      ++tail_;
    }
    return delivered_;
  }

 private:
  static constexpr std::size_t kCapacity = 128;
  struct Entry {
    Time delivery{};
    T value{};
  };

  [[nodiscard]] Duration period() const noexcept { return fromSeconds(1.0 / timing_.rate); }

  SensorTiming timing_;
  T delivered_;
  Time next_sample_{};
  std::array<Entry, kCapacity> entries_{};
  std::size_t head_{0};
  std::size_t tail_{0};
};

class Sensors {
 public:
  Sensors(const SensorConfig& config, const SensorInput& initial) noexcept;

  /// Lets every sensor that is due look at `truth`. Real-time safe: no allocation, no locks, no
  /// exceptions.
  void step(Time now, const SensorInput& truth, Random& random) noexcept;

  /// What has been delivered by `now`. Real-time safe: no allocation, no locks, no exceptions.
  [[nodiscard]] SensorReadings read(Time now) noexcept;

 private:
  SensorConfig config_;
  DelayLine<std::int64_t> encoder_;
  DelayLine<Polar> angles_;
  DelayLine<Eigen::Quaterniond> attitude_;
  DelayLine<double> barometer_;
};

}  // namespace tautline::sim
