#pragma once

/// @file
/// What a recorded flight's sensors said: an LCM log of Tautline's (STATION_INPUT), or a text log
/// of the published flights.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/estimate.h"
#include "common/time.h"
#include "common/vehicle.h"
#include "drivers/flight_log_codec.h"

namespace tautline {

/// One moment of it: everything the sensors had said by then.
struct RecordedCycle {
  Time now{};  ///< On the recording's own clock; so are the times in `sensors`.
  SensorFrame sensors;
};

/// What a text log knows beyond its sensors, one a cycle.
struct RecordedPose {
  Anchor anchor;         ///< The contact that its program worked with.
  Eigen::Vector3d p_WD;  ///< Where its program thought the drone was [m].
  FlightLogRow row;      ///< All of it, as logged.
};

struct Recording {
  std::vector<RecordedCycle> cycles;  ///< At least one, in the order of time.
  std::vector<RecordedPose> poses;    ///< Text logs: as many; otherwise empty.
  std::int64_t skipped{0};            ///< Text logs: rows that were no good, or before the flight.
  std::int64_t uninitialized{0};      ///< Of these, rows with numbers that were never set.

  [[nodiscard]] bool isTextLog() const noexcept { return !poses.empty(); }
  [[nodiscard]] Duration length() const noexcept { return cycles.back().now - cycles.front().now; }
};

/// Whether the file's first bytes are those of an LCM log. @throws InputError if it cannot be read.
/// Not real-time safe: start-up only.
[[nodiscard]] bool isLcmLog(const std::filesystem::path& file);

/// Reads either kind; which one is told by the first bytes. @throws InputError for a file that
/// cannot be read or has no flight in it. Not real-time safe: start-up only.
[[nodiscard]] Recording readRecording(const std::filesystem::path& file);

}  // namespace tautline
