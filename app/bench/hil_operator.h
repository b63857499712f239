#pragma once

/// @file
/// The operator of a flight with the real programs: what a case says in a cycle, over LCM. Never
/// waits, unlike the command line's client (app/cli/station_client.h). Not real-time safe.

#include <cstdint>
#include <deque>
#include <optional>
#include <variant>

#include <lcm/lcm-cpp.hpp>
#include <tautline/command_ack_t.hpp>
#include <tautline/mission_chunk_t.hpp>
#include <tautline/operator_command_t.hpp>

#include "common/time.h"
#include "supervision/operator_command.h"

namespace tautline::bench {

class HilOperator {
 public:
  /// `lcm` outlives the operator.
  explicit HilOperator(lcm::LCM& lcm) noexcept : lcm_(lcm) {}

  /// In this order, one after the other: each again every 200 ms until it is answered.
  void say(const OperatorCommand& command);
  void say(const tautline::mission_chunk_t& chunk);
  /// From now on; none: hands off.
  void holdSticks(const std::optional<Sticks>& sticks) noexcept { sticks_ = sticks; }

  /// Sends what is due, with heartbeats. While the link is cut nothing is sent, and what has not
  /// been answered is given up.
  void send(bool cut);
  void hear(const tautline::command_ack_t& ack);

 private:
  using Said = std::variant<tautline::operator_command_t, tautline::mission_chunk_t>;

  void beat(std::int64_t utime);
  void sendFirst(std::int64_t utime);
  void sendSticks(std::int64_t utime);

  lcm::LCM& lcm_;
  std::deque<Said> waiting_;   ///< The first is under way.
  std::optional<Time> since_;  ///< Of the first: when it was sent first; none: not yet.
  std::int64_t session_{0};    ///< 0: nothing has been said yet.
  std::int64_t beats_{0};
  std::int64_t stick_messages_{0};
  std::optional<Sticks> sticks_;
  Time next_beat_{};
  Time next_send_{};
  Time next_sticks_{};
};

}  // namespace tautline::bench
