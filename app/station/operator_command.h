#pragma once

/// @file
/// The operator's side of the station: what the `tautline` command line sends and gets back.

#include <array>
#include <cstdint>

#include "common/fields.h"
#include "supervision/supervisor.h"

namespace tautline {

/// operator_command_t.verb is a Request; this is command_ack_t.result.
enum class AckResult : std::uint8_t { kAccepted, kRefused, kUnknown, kBadMission };
inline constexpr std::array<EnumName<AckResult>, 4> kAckResultNames{
    {{AckResult::kAccepted, "accepted"},
     {AckResult::kRefused, "refused"},
     {AckResult::kUnknown, "unknown command"},
     {AckResult::kBadMission, "mission incomplete or bad"}}};

/// One command as the core sees it.
struct OperatorCommand {
  std::int64_t session{0};
  std::int32_t sequence{0};
  Request request{Request::kNone};
  std::uint64_t mission_hash{0};  ///< kNavigate only.
};

/// The core's answer.
struct CommandAck {
  std::int64_t session{0};
  std::int32_t sequence{0};
  AckResult result{AckResult::kAccepted};
  ConditionSet reasons;    ///< Conditions that refused it.
  std::int32_t detail{0};  ///< Mission chunks: waypoints received so far.
};

}  // namespace tautline
