#pragma once

/// @file
/// Which samples may be trusted this cycle: age, range, stuck and jump checks.
/// Thresholds on age are multiples of each stream's own period, which is learned from its samples:
/// the same config serves 1 Hz and 100 Hz telemetry.

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "common/fields.h"
#include "common/time.h"
#include "common/vehicle.h"

namespace tautline {

/// The streams that estimation depends on.
enum class SensorStream : std::uint8_t { kReel, kAngles, kAttitude, kVehicle };
inline constexpr std::array<EnumName<SensorStream>, 4> kSensorStreamNames{
    {{SensorStream::kReel, "reel"},
     {SensorStream::kAngles, "angles"},
     {SensorStream::kAttitude, "attitude"},
     {SensorStream::kVehicle, "vehicle"}}};
inline constexpr std::size_t kSensorStreamCount = kSensorStreamNames.size();

/// What can be wrong with one stream; bits.
enum class SensorFault : std::uint8_t {
  kMissing = 1,  ///< No sample since the start.
  kStale = 2,    ///< The last good sample is older than stale_periods of its own period.
  kRange = 4,    ///< The last sample was invalid, not finite or outside its range; not to be used.
  kStuck =
      8,  ///< Has not changed although the vehicle was commanded to move it (reel and angles only).
};
inline constexpr std::array<EnumName<SensorFault>, 4> kSensorFaultNames{
    {{SensorFault::kMissing, "missing"},
     {SensorFault::kStale, "stale"},
     {SensorFault::kRange, "range"},
     {SensorFault::kStuck, "stuck"}}};

/// Readings that moved farther between two good samples than reel or vehicle can.
struct JumpConfig {
  double length_rate_mps{2.0};
  double length_noise_m{0.05};
  double angle_rate_radps{2.0};
  double angle_noise_rad{0.08};
  double time_jitter_s{0.1};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("length_rate_mps", length_rate_mps, Range{0.01, 100},
            "no reel moves faster, slipping included");
    v.field("length_noise_m", length_noise_m, Range{0, 10}, "a step that is only noise");
    v.field("angle_rate_radps", angle_rate_radps, Range{0.01, 100},
            "the tether's direction at the drone turns no faster");
    v.field("angle_noise_rad", angle_noise_rad, Range{0, 3}, "a step that is only noise");
    v.field("time_jitter_s", time_jitter_s, Range{0, 10}, "error of the time between two samples");
  }
};

struct SensorHealthConfig {
  double initial_period_s{1.0};  ///< Assumed until a stream's own period is known.
  double stale_periods{3.0};     ///< A sample older than this many of its own periods is stale, ...
  double stale_min_s{0.5};       ///< ... but never younger than this ...
  double stale_max_s{5.0};       ///< ... and always when older than this.
  double max_length_m{200.0};    ///< Total tether length beyond this is out of range.
  double stuck_length_m{0.3};    ///< Commanded motion without any change that makes the reel stuck.
  double stuck_angle_rad{0.15};  ///< The same for the tether angles.
  JumpConfig jump;

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("initial_period_s", initial_period_s, Range{0.001, 10},
            "period assumed for a stream until it is known");
    v.field("stale_periods", stale_periods, Range{1, 100},
            "age, in periods of its own, at which a sample is stale");
    v.field("stale_min_s", stale_min_s, Range{0, 10}, "no sample younger than this is stale");
    v.field("stale_max_s", stale_max_s, Range{0.01, 60}, "every sample older than this is stale");
    v.field("max_length_m", max_length_m, Range{1, 10000},
            "tether length beyond this is out of range");
    v.field("stuck_length_m", stuck_length_m, Range{0.01, 100},
            "commanded length change without a reading that follows");
    v.field("stuck_angle_rad", stuck_angle_rad, Range{0.01, 3},
            "commanded angle change without a reading that follows");
    v.section("jump", jump);
  }
};

/// State of one stream.
struct StreamHealth {
  std::uint8_t faults{static_cast<std::uint8_t>(SensorFault::kMissing)};  ///< Of SensorFault.
  double age{0.0};          ///< Of the last good sample [s].
  double period{0.0};       ///< Learned [s].
  double stale_after{0.0};  ///< Age at which it is stale [s].
  /// From the good sample before the last one to the last one, and what reel or vehicle can have
  /// moved meanwhile; reel [m], and in flight angles [rad] as the angle between two directions, so
  /// the pole is no jump.
  double step{0.0};
  double step_allowed{0.0};

  [[nodiscard]] bool has(SensorFault fault) const noexcept {
    return (faults & static_cast<std::uint8_t>(fault)) != 0;
  }
  [[nodiscard]] bool ok() const noexcept { return faults == 0; }
  /// From a sample that jumped until the next good one that did not: neither may be what it says.
  [[nodiscard]] bool jumped() const noexcept { return step > step_allowed; }
};

struct SensorHealth {
  std::array<StreamHealth, kSensorStreamCount> streams{};

  [[nodiscard]] const StreamHealth& operator[](SensorStream stream) const noexcept {
    return streams[static_cast<std::size_t>(stream)];
  }
  /// All fault bits in one word, 4 bits a stream, kReel lowest: for telemetry.
  [[nodiscard]] std::uint32_t bits() const noexcept;
};

/// Whether a reading is finite and inside its physical range. Real-time safe: no allocation, no
/// locks, no exceptions.
[[nodiscard]] bool isPlausible(const ReelReading& reading, double max_length) noexcept;
[[nodiscard]] bool isPlausible(const TetherAngles& reading) noexcept;
[[nodiscard]] bool isPlausible(const AttitudeReading& reading) noexcept;

/// Watches the streams of one vehicle.
class SensorMonitor {
 public:
  explicit SensorMonitor(const SensorHealthConfig& config) noexcept;

  void reset() noexcept;

  /// One cycle; `command` is what was sent in the previous one. Real-time safe: no allocation, no
  /// locks, no exceptions.
  [[nodiscard]] const SensorHealth& update(Time now, const SensorFrame& frame,
                                           const VehicleCommand& command) noexcept;

 private:
  struct Stream {
    std::uint32_t sequence{0};
    bool seen{false};      ///< A good sample has arrived.
    bool last_bad{false};  ///< The newest sample failed its check.
    Time time{};           ///< Of the last good sample.
    double period{0.0};
  };
  /// Commanded motion since a reading last changed.
  struct Motion {
    double reading{0.0};
    double commanded{0.0};
  };

  /// Returns the time since the good sample before if there is a new one [s].
  template <class T>
  std::optional<double> check(SensorStream stream, Time now, const Sample<T>& sample,
                              bool plausible) noexcept;
  void watchSteps(const SensorFrame& frame, std::optional<double> since_reel,
                  std::optional<double> since_angles) noexcept;
  static bool isStuck(Motion& motion, double reading, double commanded_step, double limit) noexcept;

  SensorHealthConfig config_;
  std::array<Stream, kSensorStreamCount> streams_{};
  Motion length_, theta_, phi_;
  std::optional<double> last_length_;                ///< Of the last good sample [m].
  std::optional<Eigen::Vector3d> last_direction_{};  ///< Of the last good one in flight.
  std::optional<Time> last_update_;
  SensorHealth health_;
};

}  // namespace tautline
