#include "app/station/replay_device.h"

#include <utility>

namespace tautline {

ReplayDevice::ReplayDevice(Recording recording, double speed)
    : recording_(std::move(recording)), speed_(speed) {}

Time ReplayDevice::presentOf(Time recorded) const noexcept {
  return start_ + fromSeconds(toSeconds(recorded - recording_.cycles.front().now) / speed_);
}

template <class T>
void ReplayDevice::take(const Sample<T>& recorded, Sample<T>& out) const noexcept {
  if (recorded.sequence == out.sequence && recorded.valid == out.valid) return;
  out = recorded;
  out.time = presentOf(recorded.time);
}

void ReplayDevice::read(Time now, SensorFrame& frame) noexcept {
  if (!started_) {
    started_ = true;
    start_ = now;
  }
  const bool was_over = ended();
  const std::size_t before = next_;
  while (!ended() && presentOf(recording_.cycles[next_].now) <= now) ++next_;
  if (next_ != before) {
    const SensorFrame& recorded = recording_.cycles[next_ - 1].sensors;
    take(recorded.reel, frame.reel);
    take(recorded.angles, frame.angles);
    take(recorded.attitude, frame.attitude);
    take(recorded.gimbal, frame.gimbal);
    take(recorded.vehicle, frame.vehicle);
    take(recorded.ground, frame.ground);
    link_ = recorded.link;
  }
  if (was_over) link_.connected = false;
  frame.link = link_;
}

}  // namespace tautline
