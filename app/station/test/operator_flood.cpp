/// @file
/// Floods a station over LCM: random bytes, copies of what it hears on the operators' channels, and
/// well-formed messages with random contents. Prints what the station's loop made of it as JSON.
/// Usage: operator_flood LCM_URL MESSAGES_PER_S SECONDS

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <lcm/lcm-cpp.hpp>
#include <tautline/heartbeat_t.hpp>
#include <tautline/loop_stats_t.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline/operator_command_t.hpp>
#include <tautline/teleop_t.hpp>

#include "common/clock.h"
#include "common/loop_timer.h"
#include "lcmtypes/channels.h"

namespace {

using namespace tautline;

struct Heard {
  std::string channel;
  std::vector<std::uint8_t> bytes;
};

class Flood {
 public:
  explicit Flood(const std::string& url) : lcm_(url) {
    for (const char* name : kChannels) lcm_.subscribe(name, &Flood::onMessage, this);
    lcm_.subscribe(channel::kLoopStats, &Flood::onLoop, this);
  }
  [[nodiscard]] bool good() const { return lcm_.good(); }

  void sendOne() {
    const char* channel = kChannels[random_() % 4];
    switch (random_() % 4) {
      case 0: {
        std::vector<std::uint8_t> junk(random_() % 300);
        for (auto& byte : junk) byte = static_cast<std::uint8_t>(random_());
        publish(channel, junk);
        break;
      }
      case 1:
        if (heard_.empty()) return sendForged<operator_command_t>(channel::kOperatorCommand);
        if (const Heard& copy = heard_[random_() % heard_.size()]; true)
          publish(copy.channel, copy.bytes);
        break;
      case 2:
        return sendForged<operator_command_t>(channel::kOperatorCommand);
      default:
        if (random_() % 2 == 0) return sendForged<heartbeat_t>(channel::kHeartbeat);
        return sendForged<teleop_t>(channel::kTeleop);
    }
  }

  void listen() {
    while (lcm_.handleTimeout(0) > 0) continue;
  }

  void report(std::int64_t sent) const {
    if (!first_) {
      std::printf("{\"sent\": %lld}\n", static_cast<long long>(sent));
      return;
    }
    std::printf(
        "{\"sent\": %lld, \"cycles\": %lld, \"overruns\": %lld, \"refused\": %lld, "
        "\"work_mean_us\": %.0f}\n",
        static_cast<long long>(sent), static_cast<long long>(last_.cycles - first_->cycles),
        static_cast<long long>(last_.overruns - first_->overruns),
        static_cast<long long>(last_.commands_refused - first_->commands_refused),
        1e6 * work_most_);
  }

 private:
  static constexpr const char* kChannels[] = {channel::kOperatorCommand, channel::kMissionChunk,
                                              channel::kHeartbeat, channel::kTeleop};

  void publish(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
    lcm_.publish(channel, bytes.data(), static_cast<unsigned>(bytes.size()));
  }

  /// The right fingerprint, anything behind it.
  template <class Message>
  void sendForged(const char* channel) {
    Message m{};
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(m.getEncodedSize()));
    m.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    for (std::size_t i = 8; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(random_());
    publish(channel, bytes);
  }

  /// Keeps some of what operators send; its own messages come back too and are good enough.
  void onMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
    const auto* data = static_cast<const std::uint8_t*>(buffer->data);
    Heard heard{channel, {data, data + buffer->data_size}};
    if (heard_.size() < 64) {
      heard_.push_back(std::move(heard));
    } else if (random_() % 16 == 0) {
      heard_[random_() % heard_.size()] = std::move(heard);
    }
  }

  void onLoop(const lcm::ReceiveBuffer*, const std::string&, const loop_stats_t* m) {
    if (!first_) first_ = *m;
    last_ = *m;
    work_most_ = std::max(work_most_, m->work_mean_s);
  }

  lcm::LCM lcm_;
  std::optional<loop_stats_t> first_;
  loop_stats_t last_{};
  double work_most_{0.0};  ///< Greatest mean of a second [s].
  std::mt19937 random_{7};
  std::vector<Heard> heard_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s LCM_URL MESSAGES_PER_S SECONDS\n", argv[0]);
    return 2;
  }
  Flood flood(argv[1]);
  if (!flood.good()) return 4;
  const double rate = std::atof(argv[2]);
  const Time begin = monotonicNow();
  std::int64_t sent = 0;
  for (double t = 0.0; t < std::atof(argv[3]); t = toSeconds(monotonicNow() - begin)) {
    for (; static_cast<double>(sent) < t * rate; ++sent) flood.sendOne();
    flood.listen();
    sleepUntil(monotonicNow() + std::chrono::milliseconds(1));
  }
  flood.report(sent);
  return 0;
}
