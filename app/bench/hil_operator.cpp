#include "app/bench/hil_operator.h"

#include <tautline/heartbeat_t.hpp>
#include <tautline/teleop_t.hpp>

#include "app/station/input_message.h"
#include "app/station/operator_message.h"
#include "common/clock.h"
#include "lcmtypes/channels.h"

namespace tautline::bench {
namespace {

using std::chrono::milliseconds;

constexpr Duration kHeartbeatPeriod = milliseconds(200);
constexpr Duration kSticksPeriod = milliseconds(50);
constexpr Duration kResendAfter = milliseconds(200);
constexpr Duration kPatience = std::chrono::seconds(3);
constexpr const char* kName = "bench";

const char* channelOf(const tautline::operator_command_t&) { return channel::kOperatorCommand; }
const char* channelOf(const tautline::mission_chunk_t&) { return channel::kMissionChunk; }

}  // namespace

void HilOperator::say(const OperatorCommand& command) {
  session_ = command.session;
  waiting_.emplace_back(messageOf(command));
}

void HilOperator::say(const tautline::mission_chunk_t& chunk) {
  session_ = chunk.session;
  waiting_.emplace_back(chunk);
}

void HilOperator::send(bool cut) {
  if (cut) waiting_.clear();
  if (waiting_.empty()) since_.reset();
  if (cut || session_ == 0) return;
  const Time now = monotonicNow();
  const std::int64_t utime = toMicroseconds(now + unixOffset());
  if (now >= next_beat_) {
    next_beat_ = now + kHeartbeatPeriod;
    beat(utime);
  }
  if (!waiting_.empty() && (!since_ || now >= next_send_)) {
    if (!since_) since_ = now;
    next_send_ = now + kResendAfter;
    sendFirst(utime);
    if (now >= *since_ + kPatience) {
      waiting_.pop_front();
      since_.reset();
    }
  }
  if (sticks_ && now >= next_sticks_) {
    next_sticks_ = now + kSticksPeriod;
    sendSticks(utime);
  }
}

void HilOperator::hear(const tautline::command_ack_t& ack) {
  if (waiting_.empty()) return;
  const std::int64_t sequence =
      std::visit([](const auto& message) { return message.sequence; }, waiting_.front());
  if (ack.session != session_ || ack.sequence != sequence) return;
  // The heartbeat before it was lost, or it was too long on the way: the same message again.
  const auto result = static_cast<AckResult>(ack.result);
  if (result == AckResult::kNoHeartbeat || result == AckResult::kLate ||
      result == AckResult::kFlooded)
    return;
  waiting_.pop_front();
  since_.reset();
}

void HilOperator::beat(std::int64_t utime) {
  tautline::heartbeat_t message{};
  message.utime = utime;
  message.session = session_;
  message.sequence = ++beats_;
  put(message.name, operatorName(kName));
  lcm_.publish(channel::kHeartbeat, &message);
}

void HilOperator::sendFirst(std::int64_t utime) {
  std::visit(
      [&](auto& message) {
        message.utime = utime;
        put(message.name, operatorName(kName));
        lcm_.publish(channelOf(message), &message);
      },
      waiting_.front());
}

void HilOperator::sendSticks(std::int64_t utime) {
  tautline::teleop_t message{};
  message.utime = utime;
  message.session = sticks_->session;
  message.sequence = ++stick_messages_;
  message.dead_man = sticks_->dead_man;
  message.length_rate_mps = sticks_->rates.length;
  message.elevation_rate_radps = sticks_->rates.elevation;
  message.azimuth_rate_radps = sticks_->rates.azimuth;
  message.yaw_rate_radps = sticks_->rates.yaw;
  message.gimbal_pitch_rate_radps = sticks_->rates.gimbal_pitch;
  lcm_.publish(channel::kTeleop, &message);
}

}  // namespace tautline::bench
