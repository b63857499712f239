#pragma once

/// @file
/// How fast a recording is played and who watches.

#include <functional>

#include "common/clock.h"
#include "common/estimate.h"
#include "common/loop_timer.h"
#include "common/time.h"

namespace tautline::bench {

struct Playback {
  double speed{0.0};  ///< Times real time; 0 = as fast as it goes.
  /// Called about once for each second of the recording; may be empty.
  std::function<void(Duration since_start, const Estimate& estimate)> each_second;
};

/// Waits and tells, cycle by cycle. Not real-time safe.
class PlaybackClock {
 public:
  explicit PlaybackClock(const Playback& playback) : playback_(playback), start_(monotonicNow()) {}

  /// After the cycle at `since_start` of the recording.
  void cycle(Duration since_start, const Estimate& estimate) {
    if (playback_.speed > 0.0)
      sleepUntil(start_ + fromSeconds(toSeconds(since_start) / playback_.speed));
    if (since_start < next_) return;
    next_ = since_start + std::chrono::seconds(1);
    if (playback_.each_second) playback_.each_second(since_start, estimate);
  }

 private:
  const Playback& playback_;
  Time start_;
  Duration next_{};
};

}  // namespace tautline::bench
