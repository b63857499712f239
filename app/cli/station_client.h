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
#include <tautline/command_ack_t.hpp>
#include <tautline/estimate_t.hpp>
#include <tautline/event_t.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline/mission_status_t.hpp>
#include <tautline/operator_command_t.hpp>
#include <tautline/station_state_t.hpp>
#include <tautline/tether_state_t.hpp>
#include <tautline/vehicle_state_t.hpp>

#include "supervision/operator_command.h"
#include "common/mission_plan.h"
#include "common/time.h"

namespace tautline::cli {

class StationClient {
 public:
  /// @throws InputError (exit code kTimeout) if LCM cannot work on this machine, with the command
  /// that mends it.
  explicit StationClient(const std::string& lcm_url);

  /// Last message of each kind, if any came.
  struct View {
    std::optional<tautline::station_state_t> state;
    std::optional<tautline::mission_status_t> mission;
    std::optional<tautline::estimate_t> estimate;
    std::optional<tautline::tether_state_t> tether;
    std::optional<tautline::vehicle_state_t> vehicle;
  };
  [[nodiscard]] const View& view() const noexcept { return view_; }

  /// Handles messages until `done()` or the time is over; returns whether it is done.
  bool waitUntil(const std::function<bool()>& done, std::chrono::milliseconds timeout);

  /// Sends one command, again every 200 ms until acknowledged; nullopt: no answer in time.
  std::optional<tautline::command_ack_t> request(
      Request request, std::uint64_t mission_hash = 0,
      std::chrono::milliseconds timeout = std::chrono::seconds(3));

  /// Sends all of a mission; nullopt: no answer in time. A result other than kAccepted: refused.
  std::optional<tautline::command_ack_t> upload(const MissionPlan& plan);

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

  void onState(const lcm::ReceiveBuffer*, const std::string&, const tautline::station_state_t* m);
  void onMission(const lcm::ReceiveBuffer*, const std::string&,
                 const tautline::mission_status_t* m) {
    view_.mission = *m;
  }
  void onEstimate(const lcm::ReceiveBuffer*, const std::string&, const tautline::estimate_t* m) {
    view_.estimate = *m;
  }
  void onTether(const lcm::ReceiveBuffer*, const std::string&, const tautline::tether_state_t* m) {
    view_.tether = *m;
  }
  void onVehicle(const lcm::ReceiveBuffer*, const std::string&,
                 const tautline::vehicle_state_t* m) {
    view_.vehicle = *m;
  }
  void onAck(const lcm::ReceiveBuffer*, const std::string&, const tautline::command_ack_t* m);
  void onEventMessage(const lcm::ReceiveBuffer*, const std::string&, const tautline::event_t* m);

  lcm::LCM lcm_;
  std::int64_t session_;
  std::int32_t sequence_{0};
  View view_;
  Time last_state_{};
  std::optional<tautline::command_ack_t> ack_;
  std::function<void(const tautline::event_t&)> event_handler_;
};

}  // namespace tautline::cli
