#pragma once

/// @file
/// Telemetry straight into an LCM log file, with the messages' own times.

#include <filesystem>

#include "app/log/event_log_writer.h"
#include "app/station/telemetry.h"

namespace tautline::bench {

class LogSink final : public TelemetrySink {
 public:
  /// Starts `path` anew. @throws InputError if it cannot be written.
  explicit LogSink(const std::filesystem::path& path) : log_(path) {}

  bool publish(const char* channel, std::int64_t utime,
               std::span<const std::uint8_t> bytes) noexcept override {
    return log_.write(channel, utime, bytes);
  }

 private:
  EventLogWriter log_;
};

}  // namespace tautline::bench
