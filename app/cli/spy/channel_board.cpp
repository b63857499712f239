#include "app/cli/spy/channel_board.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace tautline::cli {
namespace {

constexpr std::size_t kFewest = 2;      // arrivals that are kept however old they are
constexpr std::size_t kMost = 20'000;   // a flood must not take all memory
constexpr double kLateIntervals = 3.0;  // a message this overdue counts as missing

DecodedMessage orNull(std::optional<double> value, double scale = 1.0) {
  return value ? DecodedMessage(*value * scale) : DecodedMessage(nullptr);
}

}  // namespace

void ChannelMeter::add(std::span<const std::uint8_t> packet, Time now) {
  ++messages_;
  last_packet_.assign(packet.begin(), packet.end());
  arrivals_.push_back({now, packet.size()});
  while (arrivals_.size() > kMost ||
         (arrivals_.size() > kFewest && arrivals_.front().at < now - kMeterWindow))
    arrivals_.pop_front();
}

Duration ChannelMeter::age(Time now) const { return now - arrivals_.back().at; }

std::optional<double> ChannelMeter::rate(Time now) const {
  if (arrivals_.size() < 2) return std::nullopt;
  const auto intervals = static_cast<double>(arrivals_.size() - 1);
  const double span = toSeconds(arrivals_.back().at - arrivals_.front().at);
  const double silence = toSeconds(age(now));
  const bool overdue = silence > kLateIntervals * span / intervals;
  return intervals / std::max(span + (overdue ? silence : 0.0), 1e-6);
}

std::optional<double> ChannelMeter::bytesPerSecond(Time now) const {
  const auto messages_a_second = rate(now);
  if (!messages_a_second) return std::nullopt;
  const auto bytes = std::accumulate(
      arrivals_.begin(), arrivals_.end(), 0.0,
      [](double sum, const Arrival& a) { return sum + static_cast<double>(a.bytes); });
  return *messages_a_second * bytes / static_cast<double>(arrivals_.size());
}

std::optional<double> ChannelMeter::jitter() const {
  if (arrivals_.size() < 3) return std::nullopt;
  const auto intervals = static_cast<double>(arrivals_.size() - 1);
  const double mean = toSeconds(arrivals_.back().at - arrivals_.front().at) / intervals;
  double squares = 0.0;
  for (std::size_t i = 1; i < arrivals_.size(); ++i) {
    const double interval = toSeconds(arrivals_[i].at - arrivals_[i - 1].at);
    squares += (interval - mean) * (interval - mean);
  }
  return std::sqrt(squares / intervals);
}

std::string typeNameOf(const ChannelMeter& channel) {
  const MessageInfo* type = channel.type();
  if (type == nullptr) return "unknown";
  const std::string name = type->name;
  return name.substr(name.rfind('.') + 1);
}

DecodedMessage jsonOf(const std::string& name, const ChannelMeter& channel, Time now) {
  const MessageInfo* type = channel.type();
  const auto fields = type == nullptr ? std::nullopt : decode(*type, channel.lastPacket());
  const auto fingerprint = fingerprintOf(channel.lastPacket());
  return {{"channel", name},
          {"type", type == nullptr ? DecodedMessage(nullptr) : DecodedMessage(type->name)},
          {"fingerprint", fingerprint ? DecodedMessage(fmt::format(
                                            "{:016x}", static_cast<std::uint64_t>(*fingerprint)))
                                      : DecodedMessage(nullptr)},
          {"messages", channel.messages()},
          {"size_bytes", channel.lastPacket().size()},
          {"rate_hz", orNull(channel.rate(now))},
          {"bytes_per_s", orNull(channel.bytesPerSecond(now))},
          {"age_ms", toSeconds(channel.age(now)) * 1e3},
          {"jitter_ms", orNull(channel.jitter(), 1e3)},
          {"fields", fields.value_or(nullptr)}};
}

}  // namespace tautline::cli
