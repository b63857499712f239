#pragma once

/// @file
/// A recorded flight in place of hardware: the sensors say what they said then, and commands go
/// nowhere.

#include <string>

#include "app/station/recording.h"
#include "common/fields.h"
#include "drivers/device.h"

namespace tautline {

struct ReplayConfig {
  std::string file;
  double speed{1.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("file", file, "LCM log with STATION_INPUT, or a text log of the published flights");
    v.field("speed", speed, Range{0.01, 1000},
            "times real time; at other speeds than 1 all motion looks that much faster");
  }
};

/// Real-time safe but for the constructor: no allocation, no locks, no exceptions.
class ReplayDevice final : public Device {
 public:
  /// Pre-condition: `speed` > 0, at least one cycle.
  ReplayDevice(Recording recording, double speed);

  /// The recording starts with the first call. Samples get the times at which they come now. At its
  /// end the link is gone.
  void read(Time now, SensorFrame& frame) noexcept override;
  void write(Time /*now*/, const VehicleCommand& /*command*/) noexcept override {}
  void shutdown(Time /*now*/) noexcept override {}
  [[nodiscard]] LinkStatus status() const noexcept override { return link_; }
  [[nodiscard]] const char* name() const noexcept override { return "replay"; }

  [[nodiscard]] bool ended() const noexcept { return next_ == recording_.cycles.size(); }
  /// Which of the recording's cycles the sensors last came from; after the first read().
  [[nodiscard]] std::size_t cycle() const noexcept { return next_ - 1; }
  [[nodiscard]] const Recording& recording() const noexcept { return recording_; }

 private:
  template <class T>
  void take(const Sample<T>& recorded, Sample<T>& out) const noexcept;
  [[nodiscard]] Time presentOf(Time recorded) const noexcept;

  Recording recording_;
  double speed_;
  std::size_t next_{0};
  bool started_{false};
  Time start_{};
  LinkStatus link_;
};

}  // namespace tautline
