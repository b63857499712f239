#pragma once

/// @file
/// Faults between the plant's sensors and the protocol emulator: what the emulator is told instead
/// of what the sensors have delivered.

#include "sim_hil/fault_schedule.h"
#include "sim_hil/sensors.h"

namespace tautline::sim {

/// Everything: real-time safe: no allocation, no locks, no exceptions.
class SensorFaults {
 public:
  /// To be called for each telegram: marks sensors silent, and changes what they say.
  /// `metres_per_count` is the encoder's nominal resolution [m].
  [[nodiscard]] SensorReadings apply(const SensorReadings& good, double metres_per_count,
                                     FaultSchedule& faults) noexcept;

  /// Measured instead of `good` [V]. Of one time, however often it is asked for.
  [[nodiscard]] double voltage(double good, FaultSchedule& faults) noexcept;

 private:
  /// One sensor's way through the stages that do not depend on what it measures.
  template <class T>
  class Channel {
   public:
    /// Changes `value` to a late or old one; returns whether the sensor is silent.
    [[nodiscard]] bool pass(FaultTarget target, T& value, FaultSchedule& faults) noexcept;

   private:
    static constexpr std::size_t kHistory = 1024;  // 2 s at 500 Hz
    History<T, kHistory> history_;
    T last_{};
    bool had_last_{false};
    LooseContact contact_;
    Time next_slow_{};
  };

  Channel<std::int64_t> encoder_;
  Channel<Polar> angles_;
  Channel<Eigen::Quaterniond> attitude_;

  Time voltage_time_{Time::min()};
  double voltage_{0.0};
  LooseContact voltage_contact_;
};

}  // namespace tautline::sim
