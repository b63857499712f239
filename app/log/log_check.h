#pragma once

/// @file
/// All that can be known of a log's soundness: its framing (EventLogReader) and whether the
/// messages in it are messages. Not real-time safe.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "app/log/event_log_reader.h"

namespace tautline {

struct LogCheck {
  std::int64_t events{};          ///< Sound ones.
  std::uint64_t bytes{};          ///< Of the file.
  std::vector<LogDamage> damage;  ///< By offset.
};

/// Reads all of `file`; `each` gets every sound event, in order. One is not sound if its data does
/// not decode as the type that it claims, or claims no known type on a channel that had one before.
/// @throws InputError for a file that cannot be read, or that has no event in it.
LogCheck checkLog(const std::filesystem::path& file,
                  const std::function<void(const LogEvent&)>& each);

}  // namespace tautline
