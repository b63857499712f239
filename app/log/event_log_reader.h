#pragma once

/// @file
/// The one reader of LCM event logs, whole or damaged. LCM's own stops at the first hole and calls
/// that the end; this one looks for the next event and says what is missing. Not real-time safe.
///
/// An event is whole if its header makes sense and the next event's sync word, or the end of the
/// file, stands right behind it. The format has no checksum: damage that lies inside one event's
/// data, or in its time, cannot be seen.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tautline {

/// One logged message. Views are valid as long as the reader.
struct LogEvent {
  std::uint64_t offset{};  ///< Of its sync word in the file [bytes].
  std::int64_t number{};   ///< Counted by the program that wrote the log, from 0.
  std::int64_t utime{};    ///< When that program received it, Unix time [us].
  std::string_view channel;
  std::span<const std::uint8_t> data;
};

/// A place of the file that is no event.
struct LogDamage {
  std::uint64_t offset{};      ///< First byte that is not part of a whole event.
  std::uint64_t bytes{};       ///< Up to the next whole event; 0: events are missing there.
  std::int64_t events_lost{};  ///< By the events' numbers.
  bool at_least{};             ///< More may be lost: no event behind tells how many.
  const char* what{};          ///< In words.
};

/// "offset 1234: 4096 bytes that are no event; 12 events lost".
[[nodiscard]] std::string describe(const LogDamage& damage);

/// What is missing of a log, in one line; empty if it is whole.
[[nodiscard]] std::string summary(const std::vector<LogDamage>& damage);

class EventLogReader {
 public:
  /// @throws InputError for a file that cannot be read, or that has no event in it.
  explicit EventLogReader(const std::filesystem::path& file);
  ~EventLogReader();
  EventLogReader(const EventLogReader&) = delete;
  EventLogReader& operator=(const EventLogReader&) = delete;

  /// Next whole event; nullopt at the end of the file.
  [[nodiscard]] std::optional<LogEvent> next();

  /// What was passed over so far, in the file's order.
  [[nodiscard]] const std::vector<LogDamage>& damage() const noexcept { return damage_; }

  [[nodiscard]] std::uint64_t fileSize() const noexcept { return bytes_.size(); }

 private:
  [[nodiscard]] std::optional<LogEvent> wholeEventAt(std::size_t offset) const;
  [[nodiscard]] std::size_t findSyncWord(std::size_t from) const;
  [[nodiscard]] bool numberIsWrong(const LogEvent& event) const;
  void noteLoss(std::size_t end, std::optional<std::int64_t> next_number);

  std::span<const std::uint8_t> bytes_;  // The mapped file.
  std::size_t position_{0};              // Behind the last whole event.
  std::int64_t expected_{0};             // Number of the next event.
  std::vector<LogDamage> damage_;
};

}  // namespace tautline
