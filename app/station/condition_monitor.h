#pragma once

/// @file
/// All detectors of a cycle in one place: what the core knows goes in as plain data, what is the
/// case comes out (docs/supervisor.md, "What is detected").

#include "common/estimate.h"
#include "common/vehicle.h"
#include "estimation/contact_observer.h"
#include "estimation/lean_tension.h"
#include "estimation/sensor_health.h"
#include "supervision/condition_filter.h"
#include "supervision/detect/detect_config.h"
#include "supervision/detect/fence.h"
#include "supervision/supervisor.h"

namespace tautline {

struct CoreConfig;

struct MonitorInput {
  Time now{};
  const SensorFrame* sensors{};  ///< Never null, as is all that follows.
  const SensorHealth* health{};
  const Estimate* estimate{};
  const Anchor* anchor{};
  const VehicleCommand* last_command{};  ///< As sent in the last cycle.
  const HostFacts* host{};
  std::int32_t missed_in_a_row{0};
  Mode mode{Mode::kStandby};  ///< Of the last cycle.
  ConditionSet facts{};       ///< What guidance and missions say.
};

/// Real-time safe: no allocation, no locks, no exceptions.
class ConditionMonitor {
 public:
  /// Keeps a reference. Not real-time safe: start-up only.
  explicit ConditionMonitor(const CoreConfig& config);

  /// One cycle: what counts, after guard and recovery times.
  [[nodiscard]] ConditionSet update(const MonitorInput& in) noexcept;

  /// What is the case in this cycle, with measured values and limits.
  [[nodiscard]] const Findings& findings() const noexcept { return findings_; }

 private:
  void watchSensors(const MonitorInput& in) noexcept;
  void watchTether(const MonitorInput& in) noexcept;
  void watchSpace(const MonitorInput& in) noexcept;
  void watchContact(const MonitorInput& in) noexcept;
  void watchVehicle(const MonitorInput& in) noexcept;

  const CoreConfig& config_;
  LeanTension lean_;
  TetherWatch tether_;
  ContactWatch contact_;
  ContactObserver observer_;
  OscillationWatch oscillation_;
  Fence fence_;
  PowerWatch power_;
  LinkWatch link_;
  HostWatch host_;
  ParkedCheck parked_;
  ReelScaleWatch reel_scale_;
  bool config_bad_;
  std::optional<Time> first_;                      ///< Cycle.
  double L_total_{0.0};                            ///< Last good reading [m].
  Eigen::Vector3d p_WA_{Eigen::Vector3d::Zero()};  ///< Anchor of the last cycle.
  Findings findings_;
  ConditionFilter filter_;
};

}  // namespace tautline
