#pragma once

/// @file
/// Command authority: one lease, held by one operator, and what it is needed for. Requests in the
/// safe direction are taken from anybody; everything else from the holder alone, and from anyone
/// while the lease is free, who thereby takes it. It expires `lease_timeout_s` after the holder's
/// last sign of life. Messages that get here have passed supervision/command_screen.h.

#include <cstdint>
#include <optional>

#include "common/time.h"
#include "common/vehicle.h"
#include "supervision/authority_config.h"
#include "supervision/condition.h"
#include "supervision/operator_command.h"

namespace tautline {

/// Whether `request` is taken from anybody: it makes a flight calmer or ends it.
[[nodiscard]] constexpr bool isSafeDirection(Request request) noexcept {
  return request == Request::kHold || request == Request::kStop || request == Request::kEstop ||
         request == Request::kLand || request == Request::kReturn;
}

struct Lease {
  std::int64_t session{0};  ///< 0: free.
  OperatorName name{};
  Time taken{};
  Time heard{};  ///< Last sign of life.

  [[nodiscard]] bool held() const noexcept { return session != 0; }
};

/// What happened to the lease in a cycle.
enum class LeaseEvent : std::uint8_t { kNone, kTaken, kTakenOver, kReleased, kExpired };

struct LeaseChange {
  LeaseEvent event{LeaseEvent::kNone};
  OperatorName from{};  ///< kTakenOver, kReleased, kExpired.
  OperatorName to{};    ///< kTaken, kTakenOver.
};

/// Real-time safe: no allocation, no locks, no exceptions.
class Authority {
 public:
  explicit Authority(const AuthorityConfig& config) noexcept : config_(config) {}

  /// First in each cycle: sign of life, expiry, sticks; those of others than the holder are
  /// ignored.
  void update(Time now, Mode mode, const std::optional<Heartbeat>& heartbeat,
              const std::optional<Sticks>& sticks) noexcept;

  /// Whether the operator may, with the lease taken, taken over or released where that is what it
  /// takes: kAccepted, kNotHolder, or kUnknown for a command that is neither request nor service.
  [[nodiscard]] AckResult decide(Time now, const OperatorCommand& command) noexcept;

  /// The same for a piece of a mission.
  [[nodiscard]] AckResult decideChunk(Time now, std::int64_t session,
                                      const OperatorName& name) noexcept;

  /// kNoOperator, kOperatorLost, kTeleopStale, kSticksMoved, as of the last update and decisions.
  [[nodiscard]] ConditionSet conditions(Time now, Mode mode) const noexcept;

  /// What the holder's sticks ask for; none without a fresh command or with the dead man's switch
  /// released.
  [[nodiscard]] std::optional<TeleopRates> rates(Time now) const noexcept;

  [[nodiscard]] const Lease& lease() const noexcept { return lease_; }
  /// Until the lease expires, if nothing is heard [s].
  [[nodiscard]] double secondsLeft(Time now) const noexcept {
    return config_.lease_timeout_s - toSeconds(now - lease_.heard);
  }
  /// Of this cycle.
  [[nodiscard]] const LeaseChange& change() const noexcept { return change_; }

  /// New limits; the lease stays as it is.
  void configure(const AuthorityConfig& config) noexcept { config_ = config; }

 private:
  [[nodiscard]] bool takeIfFree(Time now, std::int64_t session, const OperatorName& name) noexcept;
  void give(Time now, std::int64_t session, const OperatorName& name, LeaseEvent how) noexcept;
  void end(LeaseEvent how) noexcept;
  void live(Time now) noexcept;
  [[nodiscard]] bool silentFor(Time now, double seconds) const noexcept {
    return now - lease_.heard > fromSeconds(seconds);
  }
  [[nodiscard]] bool beyondDeadBand(const TeleopRates& rates) const noexcept;

  AuthorityConfig config_;
  Lease lease_;
  LeaseChange change_;
  bool lost_{false};  ///< The holder fell silent in flight; until an operator is heard again.
  std::optional<Sticks> sticks_;  ///< Holder's last.
  Time sticks_time_{};
  bool sticks_moved_{false};  ///< In this cycle, beyond the dead band.
};

}  // namespace tautline
