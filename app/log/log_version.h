#pragma once

/// @file
/// Whether the messages of a log have the layout that this version knows. LCM puts a fingerprint of
/// its type before every message: a field more is another one, and decode() refuses it without a
/// word. Not real-time safe.

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>

#include "app/log/event_log_reader.h"
#include "common/error.h"

namespace tautline {

class LogVersion {
 public:
  /// To be asked before a message of the type `Message` is decoded. False: it is of another layout.
  template <class Message>
  [[nodiscard]] bool fits(const LogEvent& event) {
    std::uint64_t fingerprint = 0;
    if (event.data.size() < sizeof(fingerprint)) return true;  // only cut
    for (std::size_t i = 0; i < sizeof(fingerprint); ++i)
      fingerprint = fingerprint << 8U | event.data[i];
    const auto ours = static_cast<std::uint64_t>(Message::getHash());
    Channel& channel = channels_[std::string(event.channel)];
    if (fingerprint == ours)
      channel.understood = true;
    else
      channel.other = {fingerprint, ours};
    return fingerprint == ours;
  }

  /// After the last message. @throws InputError if there is a channel of which no message fits.
  void check(const std::filesystem::path& file) const {
    std::string names;
    std::array<std::uint64_t, 2> example{};
    for (const auto& [name, channel] : channels_) {
      if (channel.understood) continue;
      if (names.empty()) example = channel.other;
      names += (names.empty() ? "" : ", ") + name;
    }
    if (names.empty()) return;
    throw InputError(
        {.file = file.string(),
         .key = names,
         .problem = "recorded by another version: the first one's type has the fingerprint " +
                    hex(example[0]),
         .allowed = hex(example[1]),
         .remedy = "read this log with the programs of the version that recorded it"});
  }

 private:
  struct Channel {
    bool understood{false};                ///< At least one message.
    std::array<std::uint64_t, 2> other{};  ///< Fingerprint of the last that was not, and ours.
  };
  static std::string hex(std::uint64_t value) {
    std::array<char, 17> text{};
    std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
    return text.data();
  }

  std::map<std::string, Channel> channels_;
};

}  // namespace tautline
