#pragma once

/// @file
/// Where the drone is, from tether length, tether angles at the drone, attitude and what was
/// commanded. Section 5 of docs/tether_model.md.
///
/// The filter (TetherFilter) predicts every cycle and takes each sample once, when it arrives, at
/// the sample's own time. The other variants are memoryless fixes on the newest samples, for
/// comparison. On the ground (before the vehicle says that it flies, and again when it is idle) the
/// position is held.
///
///     Localizer localizer(config);
///     localizer.reset(p_WD0, now);
///     every cycle: Estimate estimate = localizer.update(now, frame, last_command, anchor);

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "common/estimate.h"
#include "common/time.h"
#include "common/vehicle.h"
#include "estimation/localizer_config.h"
#include "estimation/sensor_health.h"
#include "estimation/tension.h"
#include "estimation/tether_filter.h"

namespace tautline {

class Localizer {
 public:
  /// Not real-time safe: start-up only.
  explicit Localizer(const LocalizerConfig& config);

  /// The drone stands at p_WD0 [m]; everything learned is forgotten. Samples that arrived before
  /// this call may still be used. Real-time safe: no allocation, no locks, no exceptions.
  void reset(const Eigen::Vector3d& p_WD0, Time now) noexcept;

  /// One cycle. `last_command` is what was sent in the previous cycle; `anchor` is the active one.
  /// Time that stands still or goes back counts as dt = 0. Readings and anchors that are not finite
  /// are never used. Real-time safe: no allocation, no locks, no exceptions.
  [[nodiscard]] Estimate update(Time now, const SensorFrame& frame,
                                const VehicleCommand& last_command, const Anchor& anchor) noexcept;

  /// Faults of the sensor streams as of the last update().
  [[nodiscard]] const SensorHealth& sensorHealth() const noexcept { return sensor_health_; }

 private:
  /// Use of one stream of samples.
  struct Stream {
    std::uint32_t sequence{0};
    std::optional<Time> used;           // time stamp of the last sample taken
    std::optional<Time> first_refused;  // when the current row of refusals began
    Time accepted{};                    // when the filter last agreed with one, or took off
    int refused{0};                     // in a row
  };
  /// A sample that is new, good and later than the one before.
  struct NewSample {
    double age;     // [s]
    double period;  // since the one before, or the stream's usual one [s]
  };

  template <class T>
  std::optional<NewSample> take(Stream& stream, SensorStream which, Time now,
                                const Sample<T>& sample, bool plausible) noexcept;
  void updateAnchor(const Anchor& anchor) noexcept;
  void updateGroundContact(Time now, const SensorFrame& frame,
                           const VehicleCommand& command) noexcept;
  void useSamples(Time now, const SensorFrame& frame) noexcept;
  void judge(Stream& stream, Time now, const Innovation& innovation) noexcept;
  void updateFix(Time now, const SensorFrame& frame) noexcept;
  [[nodiscard]] TensionEstimate memorylessTension(const SensorFrame& frame, double L,
                                                  double theta) const noexcept;
  [[nodiscard]] Estimate filterEstimate() const noexcept;
  [[nodiscard]] EstimateHealth health(Time now, const SensorFrame& frame,
                                      const Estimate& estimate) const noexcept;

  LocalizerConfig config_;
  std::optional<FixVariant> fix_variant_;
  SensorMonitor monitor_;
  SensorHealth sensor_health_;
  TetherFilter filter_;
  Anchor anchor_;
  Stream reel_, angles_, attitude_;
  std::optional<Time> last_update_;
  bool ready_{false};  // reset() was called
  bool on_ground_{true};
  bool at_home_{false};                  // since reset()
  std::optional<double> parked_length_;  // last reading there
  double nis_{1.0};                      // low-passed, per degree of freedom
  Estimate fix_;                         // last memoryless fix
  bool fix_failed_{false};
};

}  // namespace tautline
