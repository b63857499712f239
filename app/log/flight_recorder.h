#pragma once

/// @file
/// One log for each arming. What was heard in the last seconds is kept in memory; when the station
/// leaves STANDBY a file begins with it, and ends a moment after STANDBY is back. Takes messages
/// and times as arguments, so it does not know LCM. Not real-time safe.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/log/event_log_writer.h"
#include "common/time.h"

namespace tautline {

struct FlightRecorderConfig {
  std::filesystem::path folder;
  std::uint64_t quota{4ULL << 30U};               ///< Of all logs in the folder [bytes].
  Duration before{std::chrono::seconds(2)};       ///< Kept from before the arming.
  Duration after{std::chrono::seconds(2)};        ///< Recorded after STANDBY is back.
  Duration sync_period{std::chrono::seconds(1)};  ///< What a power cut may cost.
};

class FlightRecorder {
 public:
  /// `say` gets a line for people at every change.
  FlightRecorder(FlightRecorderConfig config, std::function<void(const std::string&)> say);
  /// Closes.
  ~FlightRecorder();
  FlightRecorder(const FlightRecorder&) = delete;
  FlightRecorder& operator=(const FlightRecorder&) = delete;

  /// A message, received at `utime` (Unix time [us]), which is `now`.
  void onMessage(const std::string& channel, std::int64_t utime, std::span<const std::uint8_t> data,
                 Time now);

  /// To be called some times a second: the disk, the quota, the end of a flight, a silent station.
  void tick(Time now);

  /// Ends the file, if there is one.
  void close();

  /// The file that is being written; empty if none.
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  /// The last write failed for want of room.
  [[nodiscard]] bool diskFull() const noexcept { return disk_full_; }
  /// Events that could not be written, since start.
  [[nodiscard]] std::int64_t eventsLost() const noexcept {
    return lost_before_ + (log_ ? log_->lost() : 0);
  }

 private:
  struct Message {
    std::string channel;
    std::int64_t utime{};
    std::vector<std::uint8_t> data;
    Time heard{};
  };

  void keepForStart(const std::string& channel, std::int64_t utime,
                    std::span<const std::uint8_t> data, Time now);
  void onState(std::int64_t utime, std::span<const std::uint8_t> data, Time now);
  void onMission(std::span<const std::uint8_t> data);
  void begin(std::int64_t utime, Time now);
  void append(const std::string& channel, std::int64_t utime, std::span<const std::uint8_t> data,
              Time now);
  void nameByMission(std::int64_t mission_hash);
  void onDisk(bool good, Time now);
  void enforceQuota();
  [[nodiscard]] std::filesystem::path freeName(const std::string& mission) const;

  FlightRecorderConfig config_;
  std::function<void(const std::string&)> say_;

  std::deque<Message> ring_;  // of the last seconds
  std::map<std::string, Message>
      lasting_;  // sent rarely, and no log can do without: by what it is of

  std::unique_ptr<EventLogWriter> log_;
  std::int64_t lost_before_{0};  // in the files before
  std::filesystem::path file_;
  std::string start_time_;
  std::string run_mode_;
  bool named_{false};                  // by its mission
  std::optional<Time> standby_since_;  // while recording
  Time next_sync_{};
  Time next_try_{};  // of a disk that was full, or a file that could not be made
  bool disk_full_{false};

  std::optional<Time> last_state_;
  Time started_{};
  bool silent_{false};
};

}  // namespace tautline
