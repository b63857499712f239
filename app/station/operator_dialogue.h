#pragma once

/// @file
/// The station's side of the dialogue with its operators: what they ask for in a cycle, whether
/// they may, and what they are told.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "app/station/live_parameters.h"
#include "app/station/mission_store.h"
#include "supervision/authority.h"
#include "supervision/fault_log.h"
#include "supervision/operator_command.h"

namespace tautline {

struct CoreConfig;
struct StepInput;

/// Who asked for what, and what became of it: one line of the log.
struct AuditRecord {
  OperatorName name{};  ///< Empty: only the session is known.
  std::int64_t session{0};
  const char* verb{""};  ///< As the operator typed it; static text.
  AckResult result{AckResult::kAccepted};
};

/// Real-time safe: no allocation, no locks, no exceptions.
class OperatorDialogue {
 public:
  /// `config` and `missions` must outlive it; `config` is changed by `param set`.
  OperatorDialogue(CoreConfig& config, MissionStore& missions) noexcept;

  /// Takes what arrived in this cycle; returns what the supervisor is to be asked.
  [[nodiscard]] Request take(const StepInput& in, Mode mode) noexcept;

  /// Once the supervisor has decided about that request.
  void answer(Time now, const SupervisorOutput& decision) noexcept;

  /// @name Of this cycle
  /// @{
  [[nodiscard]] const std::optional<CommandAck>& ack() const noexcept { return ack_; }
  [[nodiscard]] const std::optional<AuditRecord>& audit() const noexcept { return audit_; }
  /// The core's configuration was changed.
  [[nodiscard]] const std::optional<ParameterChange>& parameter() const noexcept {
    return parameter_;
  }
  /// @}

  [[nodiscard]] const Authority& authority() const noexcept { return authority_; }
  [[nodiscard]] const FaultLog& faults() const noexcept { return faults_; }
  [[nodiscard]] ConditionSet conditions(Time now, Mode mode) const noexcept;
  /// How often each result was given since start.
  [[nodiscard]] const AckCounts& counts() const noexcept { return counts_; }

 private:
  [[nodiscard]] AckResult serve(const OperatorCommand& command, Mode mode) noexcept;
  void say(std::int64_t session, std::int64_t sequence, AckResult result,
           ConditionSet reasons = {}) noexcept;
  void sayCommand(const OperatorCommand& command, AckResult result,
                  ConditionSet reasons = {}) noexcept;

  CoreConfig& config_;
  MissionStore& missions_;
  Authority authority_;
  FaultLog faults_;
  std::optional<OperatorCommand> asked_;  ///< Waits for the supervisor's decision.
  std::optional<CommandAck> ack_;
  std::optional<AuditRecord> audit_;
  std::optional<ParameterChange> parameter_;
  std::array<CommandAck, 16>
      answered_{};  ///< The last ones, so that a command sent again acts once.
  std::size_t next_answer_{0};
  AckCounts counts_{};
};

}  // namespace tautline
