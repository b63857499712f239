#include "app/bench/flight_log_replay.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "app/station/replay_device.h"

namespace tautline::bench {

FlightLogReplay replayFlightLog(Recording recording, const LocalizerConfig& config,
                                const Playback& playback) {
  constexpr Duration kPeriod = std::chrono::milliseconds(10);
  FlightLogReplay result;
  result.rows = static_cast<std::int64_t>(recording.cycles.size());
  result.rows_skipped = recording.skipped;
  result.duration_s = toSeconds(recording.length());

  ReplayDevice device(std::move(recording), 1.0);
  const Recording& played = device.recording();
  const auto localizer = std::make_unique<Localizer>(config);
  const Time start{std::chrono::seconds(10)};
  localizer->reset(played.poses.front().p_WD, start);
  PlaybackClock clock(playback);
  SensorFrame frame;
  std::int64_t cycles = 0;
  std::int64_t usable = 0;
  std::size_t rows_seen = 0;
  double distance_sum = 0.0;
  for (Time now = start; !device.ended(); now += kPeriod) {
    device.read(now, frame);
    const RecordedPose& pose = played.poses[device.cycle()];
    const Estimate estimate = localizer->update(now, frame, VehicleCommand{}, pose.anchor);
    ++cycles;
    usable += estimate.usable() ? 1 : 0;
    clock.cycle(now - start, estimate);
    if (device.cycle() + 1 == rows_seen) continue;
    rows_seen = device.cycle() + 1;
    const double distance = (estimate.p_WD - pose.p_WD).norm();
    distance_sum += distance;
    result.distance_max_m = std::max(result.distance_max_m, distance);
    ++result.rows_compared;
  }
  result.rows_with_contact =
      std::count_if(played.poses.begin(), played.poses.end(),
                    [](const RecordedPose& p) { return p.anchor.contact_count > 0; });
  result.reel_samples = frame.reel.sequence;
  result.angle_samples = frame.angles.sequence;
  result.usable = static_cast<double>(usable) / static_cast<double>(cycles);
  result.distance_mean_m = distance_sum / static_cast<double>(result.rows_compared);
  return result;
}

}  // namespace tautline::bench
