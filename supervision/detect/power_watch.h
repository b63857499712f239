#pragma once

/// @file
/// Batteries against their thresholds. What the vehicle itself says of its power comes with its
/// flags.

#include <optional>

#include "common/fields.h"
#include "supervision/detect/findings.h"

namespace tautline {

struct PowerConfig {
  double battery_low_v{11.1};
  double battery_critical_v{10.6};
  double backup_low_v{3.5};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("battery_low_v", battery_low_v, Range{0, 100}, "below it the drone comes home");
    v.field("battery_critical_v", battery_critical_v, Range{0, 100}, "below it the drone lands");
    v.field("backup_low_v", backup_low_v, Range{0, 100}, "of the battery on the vehicle");
  }
};

/// kBatteryLow, kBatteryCritical, kBackupBatteryLow. Real-time safe: no allocation, no locks, no
/// exceptions.
class PowerWatch {
 public:
  explicit PowerWatch(const PowerConfig& config) noexcept : config_(config) {}

  /// Voltages [V]; absent: not sensed by this device.
  void update(std::optional<double> battery, std::optional<double> backup,
              Findings& out) const noexcept {
    if (battery) {
      out.reportBelow(Condition::kBatteryLow, *battery, config_.battery_low_v);
      out.reportBelow(Condition::kBatteryCritical, *battery, config_.battery_critical_v);
    }
    if (backup) out.reportBelow(Condition::kBackupBatteryLow, *backup, config_.backup_low_v);
  }

 private:
  PowerConfig config_;
};

}  // namespace tautline
