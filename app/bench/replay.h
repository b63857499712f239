#pragma once

/// @file
/// A recorded flight stepped again: the inputs of a log through a new core, its commands compared
/// with the recorded ones. The same bytes in give the same commands out; a difference is a change
/// of behaviour.

#include <cstdint>
#include <filesystem>
#include <string>

#include "app/bench/playback.h"

namespace tautline::bench {

struct ReplayResult {
  std::int64_t cycles{0};
  std::int64_t commands_compared{0};
  std::int64_t differences{0};
  std::string first_difference;  ///< Empty if there is none.
  std::string damage;            ///< What is missing of the log; a core that missed inputs differs.
};

/// Replays `log` with the configuration that is in it. @throws InputError for a log that cannot be
/// replayed.
[[nodiscard]] ReplayResult replay(const std::filesystem::path& log, const Playback& playback = {});

}  // namespace tautline::bench
