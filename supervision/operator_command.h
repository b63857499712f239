#pragma once

/// @file
/// What operators send to the station and what they get back. All of it is of fixed size: the
/// station takes it in inside its loop.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/fields.h"
#include "common/vehicle.h"
#include "supervision/supervisor.h"

namespace tautline {

/// Who sits at the controls, e.g. "anna@bench"; ends with a zero, longer names are cut.
using OperatorName = std::array<char, 32>;

/// Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] constexpr OperatorName operatorName(std::string_view text) noexcept {
  OperatorName name{};
  std::copy_n(text.begin(), std::min(text.size(), name.size() - 1), name.begin());
  return name;
}

/// Control characters, which a terminal would obey, become '?'. Real-time safe: no allocation, no
/// locks, no exceptions.
template <class Bytes>
[[nodiscard]] constexpr OperatorName nameFromBytes(const Bytes& bytes) noexcept {
  OperatorName name{};
  for (std::size_t i = 0; i + 1 < name.size() && bytes[i] != 0; ++i) {
    const auto c = static_cast<unsigned char>(bytes[i]);
    name[i] = c < 0x20 || c == 0x7f ? '?' : static_cast<char>(c);
  }
  return name;
}

/// What becomes of a message; command_ack_t.result.
enum class AckResult : std::uint8_t {
  kAccepted,
  kRefused,      ///< Conditions are in the way.
  kUnknown,      ///< No such verb.
  kBadMission,   ///< Mission incomplete, malformed or another one than asked for.
  kOutOfMode,    ///< The mode does not allow it.
  kNotHolder,    ///< Somebody else holds the lease.
  kNoHeartbeat,  ///< From an operator who has not been heard yet.
  kLate,         ///< Too long on the way.
  kReplayed,     ///< Sequence not above the last one of its session.
  kFlooded,      ///< More than is taken from one session.
  kMalformed,    ///< Wrong size, fingerprint or value; nobody to answer.
  kLocked,       ///< Parameters and faults: only in STANDBY.
  kBadValue,     ///< No such parameter, or a value out of its range.
};
inline constexpr std::array<EnumName<AckResult>, 13> kAckResultNames{
    {{AckResult::kAccepted, "accepted"},
     {AckResult::kRefused, "refused"},
     {AckResult::kUnknown, "unknown command"},
     {AckResult::kBadMission, "mission incomplete or bad"},
     {AckResult::kOutOfMode, "not possible"},
     {AckResult::kNotHolder, "the lease is not yours"},
     {AckResult::kNoHeartbeat, "no heartbeat of this operator yet"},
     {AckResult::kLate, "too long on the way"},
     {AckResult::kReplayed, "repeated or out of order"},
     {AckResult::kFlooded, "too many messages"},
     {AckResult::kMalformed, "malformed"},
     {AckResult::kLocked, "only in STANDBY"},
     {AckResult::kBadValue, "no such parameter, or out of its range"}}};

/// How often each result was given, since start.
using AckCounts = std::array<std::int64_t, kAckResultNames.size()>;

/// What is asked of the station itself, not of its supervisor.
enum class Service : std::uint8_t {
  kNone,
  kTakeLease,
  kForceLease,  ///< Also from the operator who holds it.
  kReleaseLease,
  kSetParameter,
  kClearFaults,
};
inline constexpr std::array<EnumName<Service>, 6> kServiceNames{
    {{Service::kNone, "none"},
     {Service::kTakeLease, "lease take"},
     {Service::kForceLease, "lease take --force"},
     {Service::kReleaseLease, "lease release"},
     {Service::kSetParameter, "param set"},
     {Service::kClearFaults, "faults --clear"}}};

/// One command as the core sees it: a request or a service, never both.
struct OperatorCommand {
  std::int64_t session{0};
  std::int64_t sequence{0};
  Request request{Request::kNone};
  std::uint64_t mission_hash{0};  ///< kNavigate only.
  Service service{Service::kNone};
  std::uint64_t parameter{0};  ///< kSetParameter: hash of its key.
  double value{0.0};           ///< kSetParameter.
  OperatorName name{};
};

/// As the operator typed it. Real-time safe: no allocation, no locks, no exceptions.
[[nodiscard]] constexpr const char* verbOf(const OperatorCommand& c) noexcept {
  return c.service != Service::kNone ? nameOf(c.service, kServiceNames)
                                     : nameOf(c.request, kRequestNames);
}

/// Sign of life of an operator's program, several times a second.
struct Heartbeat {
  std::int64_t session{0};
  OperatorName name{};
};

/// The sticks. Rates count only while the dead man's switch is held.
struct Sticks {
  std::int64_t session{0};
  bool dead_man{false};
  TeleopRates rates;
};

/// A message that did not get as far as the core, to be answered by it.
struct TurnedAway {
  std::int64_t session{0};
  std::int64_t sequence{0};
  AckResult result{AckResult::kMalformed};
};

/// The core's answer.
struct CommandAck {
  std::int64_t session{0};
  std::int64_t sequence{0};
  AckResult result{AckResult::kAccepted};
  ConditionSet reasons;    ///< Conditions that refused it.
  std::int32_t detail{0};  ///< Mission chunks: waypoints received so far.
};

}  // namespace tautline
