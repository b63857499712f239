#pragma once

/// @file
/// First look at what arrives from operators: refuses what is late, repeated, out of order or too
/// much, before anybody asks what it wants. The lease is decided later (supervision/authority.h).
///
/// Clocks of operator and station need not agree. For each session the screen keeps the least
/// difference between the station's clock and the heartbeats' client time over the last 30 to 60
/// seconds: the clocks' offset plus the shortest way. A message's age is its own difference less
/// that one, so a constant delay is not seen, and a wall clock that is set back makes a session's
/// messages late for at most 60 s. LCM has no authentication: this keeps out accidents, not
/// attackers.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "common/time.h"
#include "supervision/authority_config.h"
#include "supervision/operator_command.h"

namespace tautline {

/// Messages of one stream are in sequence among themselves.
enum class OperatorStream : std::uint8_t { kCommands, kHeartbeats, kSticks };
inline constexpr std::size_t kOperatorStreams = 3;

/// What every message of an operator begins with.
struct MessageHead {
  std::int64_t client_us{0};  ///< When it was sent, client's clock [us].
  std::int64_t session{0};    ///< Not 0.
  std::int64_t sequence{0};   ///< Above 0, grows.
};

/// Real-time safe: no allocation, no locks, no exceptions.
class CommandScreen {
 public:
  explicit CommandScreen(const AuthorityConfig& config) noexcept : config_(config) {}

  /// kAccepted, or why not. The last command of a session passes again, at most ten times a second:
  /// its answer may have been lost.
  [[nodiscard]] AckResult look(Time now, OperatorStream stream, const MessageHead& head) noexcept;

  /// Bytes that are no message, and messages that were left unread because there were too many.
  void countRefused(AckResult why) noexcept { ++counts_[static_cast<std::size_t>(why)]; }

  /// Whether one more refusal may be answered and logged: at most 20 a second, the rest is counted.
  [[nodiscard]] bool mayAnswer(Time now) noexcept { return answers_.take(now, kAnswersPerSecond); }

  /// Refusals by reason; kAccepted counts messages that passed.
  [[nodiscard]] const AckCounts& counts() const noexcept { return counts_; }

 private:
  static constexpr std::size_t kSessions = 16;
  static constexpr double kAnswersPerSecond = 20.0;

  /// Token bucket that holds one second's worth.
  class Allowance {
   public:
    bool take(Time now, double per_second) noexcept;

   private:
    bool started_{false};
    double left_{0.0};
    Time since_{};
  };

  /// Least difference of two clocks over the present and the last window.
  class LeastOffset {
   public:
    void add(Time now, Duration difference) noexcept;
    [[nodiscard]] Duration least() const noexcept { return std::min(present_, before_); }

   private:
    Time window_began_{};
    Duration present_{Duration::max()};
    Duration before_{Duration::max()};
  };

  struct Session {
    std::int64_t id{0};  ///< 0: free.
    Time heard{};
    LeastOffset offset;
    std::array<std::int64_t, kOperatorStreams> last_sequence{};
    Allowance allowance;
    Time last_repeat{};
  };

  AckResult judge(Time now, OperatorStream stream, const MessageHead& head) noexcept;
  Session* find(std::int64_t session) noexcept;
  Session* add(Time now, std::int64_t session) noexcept;

  AuthorityConfig config_;
  std::array<Session, kSessions> sessions_{};
  Allowance answers_;
  AckCounts counts_{};
};

}  // namespace tautline
