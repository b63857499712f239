#include "app/cli/station_client.h"

#include <algorithm>

#include <tautline/heartbeat_t.hpp>
#include <tautline/teleop_t.hpp>

#include "app/station/mission_upload.h"
#include "app/station/operator_message.h"
#include "common/clock.h"
#include "common/error.h"
#include "lcmtypes/channels.h"
#include "lcmtypes/lcm_access.h"

namespace tautline::cli {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kResendAfter{200};
constexpr milliseconds kHeartbeatPeriod{200};

std::int64_t wallClock() { return toMicroseconds(monotonicNow() + unixOffset()); }

}  // namespace

StationClient::StationClient(const std::string& lcm_url, Role role) : lcm_(reachable(lcm_url)) {
  if (!lcm_.good()) throw cannotJoin(lcm_url);
  if (role == Role::kOperator) identity_.emplace();
  using Self = StationClient;
  lcm_.subscribe(channel::kStationState, &Self::onState, this);
  lcm_.subscribe(channel::kMissionStatus, &Self::keep<mission_status_t, &View::mission>, this);
  lcm_.subscribe(channel::kEstimate, &Self::keep<estimate_t, &View::estimate>, this);
  lcm_.subscribe(channel::kTetherState, &Self::keep<tether_state_t, &View::tether>, this);
  lcm_.subscribe(channel::kVehicleState, &Self::keep<vehicle_state_t, &View::vehicle>, this);
  lcm_.subscribe(channel::kAuthority, &Self::keep<authority_t, &View::authority>, this);
  lcm_.subscribe(channel::kSafety, &Self::keep<safety_t, &View::safety>, this);
  lcm_.subscribe(channel::kFaults, &Self::keep<faults_t, &View::faults>, this);
  lcm_.subscribe(channel::kParams, &Self::onParams, this);
  lcm_.subscribe(channel::kCommandAck, &Self::onAck, this);
  lcm_.subscribe(channel::kEvent, &Self::onEventMessage, this);
}

void StationClient::onState(const lcm::ReceiveBuffer*, const std::string&,
                            const tautline::station_state_t* m) {
  view_.state = *m;
  last_state_ = monotonicNow();
}

void StationClient::onParams(const lcm::ReceiveBuffer*, const std::string&,
                             const tautline::params_t* m) {
  if (m->program == "tautline-station") view_.params = *m;
}

bool StationClient::silent() const {
  return view_.state && monotonicNow() - last_state_ > std::chrono::seconds(3);
}

void StationClient::onAck(const lcm::ReceiveBuffer*, const std::string&,
                          const tautline::command_ack_t* m) {
  if (m->session == session()) ack_ = *m;
}

void StationClient::onEventMessage(const lcm::ReceiveBuffer*, const std::string&,
                                   const tautline::event_t* m) {
  if (event_handler_) event_handler_(*m);
}

void StationClient::beat() {
  next_beat_ = monotonicNow() + kHeartbeatPeriod;
  tautline::heartbeat_t message{};
  message.session = identity_->session();
  message.sequence = identity_->nextSequence();
  put(message.name, operatorName(identity_->name()));
  message.utime = wallClock();
  lcm_.publish(channel::kHeartbeat, &message);
}

void StationClient::beatIfDue() {
  if (identity_ && monotonicNow() >= next_beat_) beat();
}

bool StationClient::waitUntil(const std::function<bool()>& done, milliseconds timeout) {
  const Time end = monotonicNow() + timeout;
  while (!done()) {
    beatIfDue();
    const auto left = std::chrono::duration_cast<milliseconds>(end - monotonicNow());
    if (left.count() <= 0) return false;
    lcm_.handleTimeout(static_cast<int>(std::min(left, milliseconds(50)).count()));
  }
  return true;
}

template <class Message>
std::optional<tautline::command_ack_t> StationClient::sendUntilAcknowledged(const char* channel,
                                                                            Message& message,
                                                                            milliseconds timeout) {
  TAUTLINE_CHECK(identity_);
  message.session = identity_->session();
  message.sequence = identity_->nextSequence();
  put(message.name, operatorName(identity_->name()));
  const auto answered = [&] { return ack_ && ack_->sequence == message.sequence; };
  for (milliseconds waited{0}; waited < timeout; waited += kResendAfter) {
    ack_.reset();
    beat();  // the station takes nothing from a session that it has not heard
    message.utime = wallClock();
    lcm_.publish(channel, &message);
    if (!waitUntil(answered, kResendAfter)) continue;
    // The heartbeat was lost, or others were before it: the same message again.
    const auto result = static_cast<AckResult>(ack_->result);
    if (result != AckResult::kNoHeartbeat && result != AckResult::kLate &&
        result != AckResult::kFlooded)
      break;
    waitUntil([] { return false; }, kResendAfter);
  }
  return answered() ? ack_ : std::nullopt;
}

std::optional<tautline::command_ack_t> StationClient::send(OperatorCommand command,
                                                           milliseconds timeout) {
  tautline::operator_command_t message = messageOf(command);
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

void StationClient::sendSticks(bool dead_man, const TeleopRates& rates) {
  TAUTLINE_CHECK(identity_);
  tautline::teleop_t message{};
  message.session = identity_->session();
  message.sequence = identity_->nextSequence();
  message.dead_man = dead_man;
  message.length_rate_mps = rates.length;
  message.elevation_rate_radps = rates.elevation;
  message.azimuth_rate_radps = rates.azimuth;
  message.yaw_rate_radps = rates.yaw;
  message.gimbal_pitch_rate_radps = rates.gimbal_pitch;
  message.utime = wallClock();
  lcm_.publish(channel::kTeleop, &message);
}

}  // namespace tautline::cli
