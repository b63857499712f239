#pragma once

/// @file
/// The one writer of LCM event logs, on liblcm's own functions. A full disk costs what does not fit
/// on it and no more: the log goes on, whole, as soon as there is room. Not real-time safe.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include <lcm/eventlog.h>

namespace tautline {

class EventLogWriter {
 public:
  /// Starts `file` anew, and holds a lock on it as long as this object lives (isBeingWritten()).
  /// @throws InputError if it cannot be written.
  explicit EventLogWriter(const std::filesystem::path& file);
  /// Flushes.
  ~EventLogWriter();
  EventLogWriter(const EventLogWriter&) = delete;
  EventLogWriter& operator=(const EventLogWriter&) = delete;

  /// Appends an event. Of those since the last flush() nothing is certain to be on the disk.
  /// False: there was no room, and all of them were dropped; the numbers of the log's events show
  /// how many.
  bool write(std::string_view channel, std::int64_t utime,
             std::span<const std::uint8_t> data) noexcept;

  /// Hands everything to the kernel; false as above.
  bool flush() noexcept;

  /// flush(), and waits until it is on the disk.
  bool sync() noexcept;

  /// Counts an event that is not tried to be written.
  void skip() noexcept;

  /// Events since the last flush().
  [[nodiscard]] std::int64_t unflushed() const noexcept { return written_ - flushed_written_; }
  [[nodiscard]] std::int64_t written() const noexcept { return written_; }
  [[nodiscard]] std::int64_t lost() const noexcept { return number_ - written_; }

 private:
  void dropUnflushed() noexcept;  // errno stays

  struct Close {
    void operator()(lcm_eventlog_t* log) const noexcept { lcm_eventlog_destroy(log); }
  };
  std::unique_ptr<lcm_eventlog_t, Close> log_;
  std::int64_t number_{0};           // Of the next event.
  std::int64_t written_{0};          // Events in the file, or on their way.
  std::int64_t flushed_written_{0};  // As of the last flush: events,
  std::int64_t flushed_end_{0};      // and size of the file [bytes].
};

/// Whether an EventLogWriter, of any process, is at that file now.
[[nodiscard]] bool isBeingWritten(const std::filesystem::path& file) noexcept;

}  // namespace tautline
