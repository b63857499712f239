#pragma once

/// @file
/// What operators sent, from the network's bytes to the one cycle's input of the core: decodes,
/// screens and counts. Any bytes are harmless here (app/station/fuzz).

#include <cstdint>
#include <optional>
#include <span>

#include <tautline/mission_chunk_t.hpp>

#include "app/station/station.h"
#include "supervision/command_screen.h"
#include "supervision/operator_command.h"

namespace tautline {

/// Takes any number of messages in a cycle and keeps, of the commands and mission pieces, the one
/// that matters most: emergency stop before the safe direction before other commands before pieces
/// of a mission. What has to stand back counts as flooded; its sender sends it again. Real-time
/// safe: no allocation, no locks, no exceptions.
class OperatorInbox {
 public:
  explicit OperatorInbox(const AuthorityConfig& config) noexcept : screen_(config) {}

  /// Empties it. Heartbeats and sticks of others than `holder` only teach the screen.
  void beginCycle(Time now, std::int64_t holder) noexcept;

  /// @name One message as it arrived
  /// @{
  void command(std::span<const std::uint8_t> bytes) noexcept;
  void chunk(std::span<const std::uint8_t> bytes) noexcept;
  void heartbeat(std::span<const std::uint8_t> bytes) noexcept;
  void sticks(std::span<const std::uint8_t> bytes) noexcept;
  /// @}

  /// There was more than may be taken in one cycle.
  void overflowed() noexcept { screen_.countRefused(AckResult::kFlooded); }

  /// What the cycle brought; the chunk stays in here until the next one.
  void fill(StepInput& in) const noexcept;

  /// What was refused before the core saw it, by reason.
  [[nodiscard]] const AckCounts& counts() const noexcept { return screen_.counts(); }

 private:
  [[nodiscard]] bool passes(OperatorStream stream, const MessageHead& head) noexcept;
  [[nodiscard]] bool outranks(int rank) noexcept;

  CommandScreen screen_;
  Time now_{};
  std::int64_t holder_{0};
  int rank_{0};  ///< Of the command or mission piece that is kept; 0: none.
  std::optional<OperatorCommand> command_;
  std::optional<tautline::mission_chunk_t> chunk_;
  std::optional<Heartbeat> heartbeat_;
  std::optional<Sticks> sticks_;
  std::optional<TurnedAway> turned_away_;
};

}  // namespace tautline
