#pragma once

/// @file
/// A client of the station over LCM: sends commands and missions until they are acknowledged, and
/// follows the state that the station publishes. Not real-time safe: for operator tools only.

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <lcm/lcm-cpp.hpp>
#include <tautline/authority_t.hpp>
#include <tautline/command_ack_t.hpp>
#include <tautline/estimate_t.hpp>
#include <tautline/event_t.hpp>
#include <tautline/faults_t.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline/mission_status_t.hpp>
#include <tautline/params_t.hpp>
#include <tautline/safety_t.hpp>
#include <tautline/station_state_t.hpp>
#include <tautline/tether_state_t.hpp>
#include <tautline/vehicle_state_t.hpp>

#include "app/cli/operator_identity.h"
#include "common/mission_plan.h"
#include "common/time.h"
#include "supervision/operator_command.h"

namespace tautline::cli {

/// Whether the client only listens or is an operator, who sends heartbeats while it waits.
enum class Role : std::uint8_t { kListener, kOperator };

class StationClient {
 public:
  /// @throws InputError (exit code kTimeout) if LCM cannot work on this machine, with the command
  /// that mends it.
  StationClient(const std::string& lcm_url, Role role);

  /// Last message of each kind, if any came.
  struct View {
    std::optional<tautline::station_state_t> state;
    std::optional<tautline::mission_status_t> mission;
    std::optional<tautline::estimate_t> estimate;
    std::optional<tautline::tether_state_t> tether;
    std::optional<tautline::vehicle_state_t> vehicle;
    std::optional<tautline::authority_t> authority;
    std::optional<tautline::safety_t> safety;
    std::optional<tautline::faults_t> faults;
    std::optional<tautline::params_t> params;  ///< Of the station; every 10 s.
  };
  [[nodiscard]] const View& view() const noexcept { return view_; }

  /// Handles messages until `done()` or the time is over; returns whether it is done.
  bool waitUntil(const std::function<bool()>& done, std::chrono::milliseconds timeout);

  /// Sends one command, again every 200 ms until acknowledged; nullopt: no answer in time. Session,
  /// sequence and name are filled in.
  std::optional<tautline::command_ack_t> send(
      OperatorCommand command, std::chrono::milliseconds timeout = std::chrono::seconds(3));

  /// Sends all of a mission; nullopt: no answer in time. A result other than kAccepted: refused.
  std::optional<tautline::command_ack_t> upload(const MissionPlan& plan);

  /// One stick command; not acknowledged.
  void sendSticks(bool dead_man, const TeleopRates& rates);

  /// The session of this operator, 0 for a listener.
  [[nodiscard]] std::int64_t session() const noexcept {
    return identity_ ? identity_->session() : 0;
  }

  /// No state message for three seconds, after there had been some: the station, or the way to it,
  /// is gone.
  [[nodiscard]] bool silent() const;

  /// Called for each EVENT while waiting.
  void onEvent(std::function<void(const tautline::event_t&)> handler) {
    event_handler_ = std::move(handler);
  }

 private:
  template <class Message>
  std::optional<tautline::command_ack_t> sendUntilAcknowledged(const char* channel,
                                                               Message& message,
                                                               std::chrono::milliseconds timeout);
  void beat();
  void beatIfDue();

  void onState(const lcm::ReceiveBuffer*, const std::string&, const tautline::station_state_t* m);
  template <class Message, std::optional<Message> View::*last>
  void keep(const lcm::ReceiveBuffer*, const std::string&, const Message* m) {
    view_.*last = *m;
  }
  void onParams(const lcm::ReceiveBuffer*, const std::string&, const tautline::params_t* m);
  void onAck(const lcm::ReceiveBuffer*, const std::string&, const tautline::command_ack_t* m);
  void onEventMessage(const lcm::ReceiveBuffer*, const std::string&, const tautline::event_t* m);

  lcm::LCM lcm_;
  std::optional<OperatorIdentity> identity_;  ///< Of an operator.
  Time next_beat_{};
  View view_;
  Time last_state_{};
  std::optional<tautline::command_ack_t> ack_;
  std::function<void(const tautline::event_t&)> event_handler_;
};

}  // namespace tautline::cli
