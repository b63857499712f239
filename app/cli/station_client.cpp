#include "app/cli/station_client.h"

#include <algorithm>
#include <random>

#include "app/lcm_access.h"
#include "app/station/mission_upload.h"
#include "common/clock.h"
#include "common/error.h"
#include "lcmtypes/channels.h"

namespace tautline::cli {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kResendAfter{200};

std::int64_t newSession() {
  std::random_device device;
  return static_cast<std::int64_t>((static_cast<std::uint64_t>(device()) << 32) | device());
}

}  // namespace

StationClient::StationClient(const std::string& lcm_url)
    : lcm_(reachable(lcm_url)), session_(newSession()) {
  if (!lcm_.good()) throw cannotJoin(lcm_url);
  lcm_.subscribe(channel::kStationState, &StationClient::onState, this);
  lcm_.subscribe(channel::kMissionStatus, &StationClient::onMission, this);
  lcm_.subscribe(channel::kEstimate, &StationClient::onEstimate, this);
  lcm_.subscribe(channel::kTetherState, &StationClient::onTether, this);
  lcm_.subscribe(channel::kVehicleState, &StationClient::onVehicle, this);
  lcm_.subscribe(channel::kCommandAck, &StationClient::onAck, this);
  lcm_.subscribe(channel::kEvent, &StationClient::onEventMessage, this);
}

void StationClient::onState(const lcm::ReceiveBuffer*, const std::string&,
                            const tautline::station_state_t* m) {
  view_.state = *m;
  last_state_ = monotonicNow();
}

bool StationClient::silent() const {
  return view_.state && monotonicNow() - last_state_ > std::chrono::seconds(3);
}

void StationClient::onAck(const lcm::ReceiveBuffer*, const std::string&,
                          const tautline::command_ack_t* m) {
  if (m->session == session_) ack_ = *m;
}

void StationClient::onEventMessage(const lcm::ReceiveBuffer*, const std::string&,
                                   const tautline::event_t* m) {
  if (event_handler_) event_handler_(*m);
}

bool StationClient::waitUntil(const std::function<bool()>& done, milliseconds timeout) {
  const Time end = monotonicNow() + timeout;
  while (!done()) {
    const auto left = std::chrono::duration_cast<milliseconds>(end - monotonicNow());
    if (left.count() <= 0) return false;
    lcm_.handleTimeout(static_cast<int>(std::min(left, milliseconds(100)).count()));
  }
  return true;
}

template <class Message>
std::optional<tautline::command_ack_t> StationClient::sendUntilAcknowledged(const char* channel,
                                                                            Message& message,
                                                                            milliseconds timeout) {
  message.session = session_;
  message.sequence = ++sequence_;
  const auto answered = [&] { return ack_ && ack_->sequence == message.sequence; };
  ack_.reset();
  for (milliseconds waited{0}; waited < timeout; waited += kResendAfter) {
    message.utime = toMicroseconds(monotonicNow() + unixOffset());
    lcm_.publish(channel, &message);
    if (waitUntil(answered, kResendAfter)) return ack_;
  }
  return std::nullopt;
}

std::optional<tautline::command_ack_t> StationClient::request(Request request,
                                                              std::uint64_t mission_hash,
                                                              milliseconds timeout) {
  tautline::operator_command_t message{};
  message.verb = static_cast<std::int8_t>(request);
  message.mission_hash = static_cast<std::int64_t>(mission_hash);
  return sendUntilAcknowledged(channel::kOperatorCommand, message, timeout);
}

std::optional<tautline::command_ack_t> StationClient::upload(const MissionPlan& plan) {
  std::optional<tautline::command_ack_t> ack;
  forEachChunk(plan, [&](tautline::mission_chunk_t& chunk) {
    ack = sendUntilAcknowledged(channel::kMissionChunk, chunk, std::chrono::seconds(3));
    return ack && ack->result == static_cast<std::int8_t>(AckResult::kAccepted);
  });
  return ack;
}

}  // namespace tautline::cli
