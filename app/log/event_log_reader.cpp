#include "app/log/event_log_reader.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "common/error.h"

namespace tautline {
namespace {

constexpr std::array<std::uint8_t, 4> kSyncWord{0xED, 0xA1, 0xDA, 0x01};
constexpr std::size_t kHeader = 28;           // sync word, number, time, both lengths [bytes]
constexpr std::size_t kLongestChannel = 999;  // what LCM's own reader takes

template <class Unsigned>
Unsigned bigEndian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes.first(sizeof(Unsigned))) value = value << 8 | byte;
  return static_cast<Unsigned>(value);
}

/// Whether an event is whole, by what stands behind it: the next sync word or the end of the file.
/// A cut or a hole (of zeros, as file systems leave them) may begin within that sync word.
bool endsWhole(std::span<const std::uint8_t> behind) {
  const auto same = static_cast<std::size_t>(
      std::mismatch(behind.begin(), behind.end(), kSyncWord.begin(), kSyncWord.end()).first -
      behind.begin());
  if (same == kSyncWord.size() || same == behind.size()) return true;
  const auto hole = behind.subspan(same, std::min(behind.size(), kHeader) - same);
  return same > 0 && std::all_of(hole.begin(), hole.end(), [](std::uint8_t b) { return b == 0; });
}

[[noreturn]] void cannotRead(const std::filesystem::path& file, const std::string& problem) {
  throw InputError(
      {.file = file.string(),
       .problem = problem,
       .remedy = "name a log that `tautline log record`, lcm-logger or the bench wrote"});
}

/// The whole file in memory, or an empty span for an empty file.
std::span<const std::uint8_t> mapped(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) cannotRead(file, std::string("this log cannot be read: ") + std::strerror(errno));
  struct stat status {};
  const bool regular = ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
  const auto size = static_cast<std::size_t>(status.st_size);
  void* memory = nullptr;
  if (regular && size > 0) memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
  ::close(fd);
  if (!regular) cannotRead(file, "this log cannot be read: no regular file");
  if (size == 0) cannotRead(file, "is empty, there is no event in it");
  if (memory == MAP_FAILED)
    cannotRead(file, std::string("this log cannot be read: ") + std::strerror(errno));
  return {static_cast<const std::uint8_t*>(memory), size};
}

std::string eventsLost(std::int64_t events, bool at_least) {
  return std::string(at_least ? "at least " : "") + std::to_string(events) +
         (events == 1 ? " event lost" : " events lost");
}

}  // namespace

std::string describe(const LogDamage& damage) {
  std::string text = "offset " + std::to_string(damage.offset) + ": ";
  if (damage.bytes > 0) text += std::to_string(damage.bytes) + " bytes, ";
  return text + damage.what + "; " + eventsLost(damage.events_lost, damage.at_least);
}

std::string summary(const std::vector<LogDamage>& damage) {
  if (damage.empty()) return {};
  std::int64_t events = 0;
  bool at_least = false;
  for (const LogDamage& d : damage) {
    events += d.events_lost;
    at_least = at_least || d.at_least;
  }
  return "damaged in " + std::to_string(damage.size()) +
         (damage.size() == 1 ? " place, " : " places, ") + eventsLost(events, at_least);
}

EventLogReader::EventLogReader(const std::filesystem::path& file) : bytes_(mapped(file)) {
  for (std::size_t at = findSyncWord(0); at < bytes_.size(); at = findSyncWord(at + 1)) {
    const auto event = wholeEventAt(at);
    if (!event) continue;
    // A piece of a longer log begins with whatever number it has.
    if (at == 0) expected_ = event->number;
    return;
  }
  ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
  cannotRead(file, "has no event of an LCM log in it");
}

EventLogReader::~EventLogReader() {
  ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

std::size_t EventLogReader::findSyncWord(std::size_t from) const {
  return static_cast<std::size_t>(std::search(bytes_.begin() + static_cast<std::ptrdiff_t>(from),
                                              bytes_.end(), kSyncWord.begin(), kSyncWord.end()) -
                                  bytes_.begin());
}

std::optional<LogEvent> EventLogReader::wholeEventAt(std::size_t offset) const {
  const auto rest = bytes_.subspan(offset);
  if (rest.size() < kHeader || !std::equal(kSyncWord.begin(), kSyncWord.end(), rest.begin()))
    return std::nullopt;
  LogEvent event;
  event.offset = offset;
  event.number = bigEndian<std::int64_t>(rest.subspan(4));
  event.utime = bigEndian<std::int64_t>(rest.subspan(12));
  const std::size_t channel_size = bigEndian<std::uint32_t>(rest.subspan(20));
  const std::size_t data_size = bigEndian<std::uint32_t>(rest.subspan(24));
  if (event.number < 0 || channel_size < 1 || channel_size > kLongestChannel) return std::nullopt;
  if (data_size > rest.size() || kHeader + channel_size + data_size > rest.size())
    return std::nullopt;
  if (!endsWhole(rest.subspan(kHeader + channel_size + data_size))) return std::nullopt;
  const auto channel = rest.subspan(kHeader, channel_size);
  if (std::any_of(channel.begin(), channel.end(), [](std::uint8_t c) { return c < ' '; }))
    return std::nullopt;
  event.channel = {reinterpret_cast<const char*>(channel.data()), channel_size};
  event.data = rest.subspan(kHeader + channel_size, data_size);
  return event;
}

/// An event in its place whose number fits neither to the one before nor to the one behind, which
/// fit to each other: its header is damaged.
bool EventLogReader::numberIsWrong(const LogEvent& event) const {
  if (event.offset != position_ || event.number == expected_) return false;
  const auto behind =
      static_cast<std::size_t>(event.data.data() + event.data.size() - bytes_.data());
  const auto following = wholeEventAt(behind);
  return following && following->number == expected_ + 1;
}

void EventLogReader::noteLoss(std::size_t end, std::optional<std::int64_t> next_number) {
  LogDamage damage{.offset = position_, .bytes = end - position_};
  const bool counted = next_number && *next_number >= expected_;
  // Numbers that start anew are those of another log behind this one.
  if (damage.bytes == 0 && (!counted || *next_number == expected_)) return;
  damage.events_lost = counted ? *next_number - expected_ : 1;
  damage.at_least = !counted;
  damage.what = damage.bytes == 0 ? "whole events are missing"
                : next_number     ? "no whole event"
                                  : "the file ends within an event";
  damage_.push_back(damage);
}

std::optional<LogEvent> EventLogReader::next() {
  for (std::size_t at = findSyncWord(position_); at < bytes_.size(); at = findSyncWord(at + 1)) {
    const auto event = wholeEventAt(at);
    if (!event || numberIsWrong(*event)) continue;
    noteLoss(at, event->number);
    position_ = static_cast<std::size_t>(event->data.data() + event->data.size() - bytes_.data());
    expected_ = event->number + 1;
    return event;
  }
  noteLoss(bytes_.size(), std::nullopt);
  position_ = bytes_.size();
  return std::nullopt;
}

}  // namespace tautline
