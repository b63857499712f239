#pragma once

/// @file
/// A device as the station's loop knows it. The loop calls read() and write() once a cycle, in this
/// order, with the time of the cycle; all protocol, unit and calibration knowledge is behind this
/// interface.

#include "common/time.h"
#include "common/vehicle.h"

namespace tautline {

/// Real-time safe: no allocation, no locks, no exceptions; no method waits for the device.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  /// Puts what arrived since the last call into `frame`. Samples without news are left as they are,
  /// so one frame, kept by the caller from cycle to cycle, always holds the latest of everything.
  /// Also updates `frame.link`.
  virtual void read(Time now, SensorFrame& frame) noexcept = 0;

  /// Sends `command`, at the pace the device can take.
  virtual void write(Time now, const VehicleCommand& command) noexcept = 0;

  /// Last words before the program ends: zero rates, then leave remote control. Nothing may be
  /// written afterwards.
  virtual void shutdown(Time now) noexcept = 0;

  [[nodiscard]] virtual LinkStatus status() const noexcept = 0;

  /// Short name for messages, e.g. "fotokite".
  [[nodiscard]] virtual const char* name() const noexcept = 0;
};

}  // namespace tautline
