#pragma once

/// @file
/// What was heard on every LCM channel: how often, how much, how evenly, and the last packet. Not
/// real-time safe.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/log/message_decoder.h"
#include "common/time.h"

namespace tautline::cli {

/// One channel. Rates are over the last seconds: kMeterWindow, or the last two messages where they
/// are rarer.
class ChannelMeter {
 public:
  void add(std::span<const std::uint8_t> packet, Time now);

  [[nodiscard]] std::int64_t messages() const noexcept { return messages_; }
  [[nodiscard]] const std::vector<std::uint8_t>& lastPacket() const noexcept {
    return last_packet_;
  }

  /// Since the last message.
  [[nodiscard]] Duration age(Time now) const;
  /// Messages a second; falls once they no longer come. Nullopt before the second one.
  [[nodiscard]] std::optional<double> rate(Time now) const;
  /// Bytes of messages a second, LCM's own headers not counted; nullopt before the second message.
  [[nodiscard]] std::optional<double> bytesPerSecond(Time now) const;
  /// Standard deviation of the time between messages [s]; nullopt before the third one.
  [[nodiscard]] std::optional<double> jitter() const;

  /// Type of the last packet; nullptr if unknown.
  [[nodiscard]] const MessageInfo* type() const { return findMessage(last_packet_); }

 private:
  struct Arrival {
    Time at{};
    std::size_t bytes{};
  };
  std::deque<Arrival> arrivals_;
  std::int64_t messages_{0};
  std::vector<std::uint8_t> last_packet_;
};

inline constexpr Duration kMeterWindow = std::chrono::seconds(5);

/// All channels by name.
using ChannelBoard = std::map<std::string, ChannelMeter>;

/// The type's name without its package, or "unknown".
[[nodiscard]] std::string typeNameOf(const ChannelMeter& channel);

/// Everything about one channel, for machines: channel, type, messages, rate_hz, bytes_per_s,
/// age_ms, jitter_ms, size_bytes, fields. null: not known, or not decoded.
[[nodiscard]] DecodedMessage jsonOf(const std::string& name, const ChannelMeter& channel, Time now);

}  // namespace tautline::cli
