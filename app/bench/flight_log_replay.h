#pragma once

/// @file
/// A text log of the published flights through the estimator: its sensors, and the contacts that
/// its program worked with, against where its program thought the drone was.

#include <cstdint>

#include "app/bench/playback.h"
#include "app/station/recording.h"
#include "estimation/localizer.h"

namespace tautline::bench {

struct FlightLogReplay {
  std::int64_t rows{0};
  std::int64_t rows_skipped{0};
  std::int64_t rows_with_contact{0};
  std::int64_t rows_compared{0};  ///< Several that fall into one cycle count once.
  std::uint32_t reel_samples{0};
  std::uint32_t angle_samples{0};
  double duration_s{0.0};
  double usable{0.0};           ///< Share of the time with an estimate that may be acted on.
  double distance_mean_m{0.0};  ///< Estimate to the log's own position, at its rows.
  double distance_max_m{0.0};
};

/// Plays `recording` on a virtual clock of 100 Hz. The vehicle is taken to fly from the first row
/// on. Pre-condition: recording.isTextLog().
[[nodiscard]] FlightLogReplay replayFlightLog(Recording recording, const LocalizerConfig& config,
                                              const Playback& playback);

}  // namespace tautline::bench
