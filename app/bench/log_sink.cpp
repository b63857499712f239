#include "app/bench/log_sink.h"

#include <array>
#include <cstring>

#include "common/error.h"

namespace tautline::bench {

LogSink::LogSink(const std::filesystem::path& path) : log_(lcm_eventlog_create(path.c_str(), "w")) {
  if (log_ == nullptr) {
    throw InputError({.file = path.string(),
                      .problem = "cannot be written",
                      .remedy = "choose a folder that exists and is yours"});
  }
}

LogSink::~LogSink() { lcm_eventlog_destroy(log_); }

bool LogSink::publish(const char* channel, std::int64_t utime,
                      std::span<const std::uint8_t> bytes) noexcept {
  std::array<char, 64> name{};
  std::array<std::uint8_t, 65536> data{};
  const std::size_t length = std::strlen(channel);
  if (length >= name.size() || bytes.size() > data.size()) return false;
  // LCM's event has pointers to what may change, so it gets copies.
  std::memcpy(name.data(), channel, length);
  std::memcpy(data.data(), bytes.data(), bytes.size());
  lcm_eventlog_event_t event{};
  event.timestamp = utime;
  event.channellen = static_cast<std::int32_t>(length);
  event.datalen = static_cast<std::int32_t>(bytes.size());
  event.channel = name.data();
  event.data = data.data();
  return lcm_eventlog_write_event(log_, &event) == 0;
}

}  // namespace tautline::bench
