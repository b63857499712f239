#pragma once

/// @file
/// Who may command the station, for how long, and how fresh a message must be.

#include <array>
#include <cstdint>

#include "common/fields.h"

namespace tautline {

/// What a mission does when the operator who holds the lease falls silent.
enum class WithoutOperator : std::uint8_t { kGoOn, kHold };
inline constexpr std::array<EnumName<WithoutOperator>, 2> kWithoutOperatorNames{
    {{WithoutOperator::kGoOn, "go_on"}, {WithoutOperator::kHold, "hold"}}};

struct AuthorityConfig {
  double lease_timeout_s{10.0};
  WithoutOperator auto_without_operator{WithoutOperator::kGoOn};
  double teleop_heartbeat_timeout_s{0.5};
  double stick_timeout_s{0.2};
  double stick_dead_band{0.02};
  double max_message_age_s{0.3};
  double max_messages_per_s{100.0};

  template <class Visitor>
  void fields(Visitor& v) {
    v.field("lease_timeout_s", lease_timeout_s, Range{1, 600},
            "the lease is free this long after its holder's last heartbeat");
    v.choice("auto_without_operator", auto_without_operator, kWithoutOperatorNames,
             "what a mission does when the holder has been silent for as long as that");
    v.field("teleop_heartbeat_timeout_s", teleop_heartbeat_timeout_s, Range{0.25, 5},
            "TELEOP ends this long after the holder's last heartbeat");
    v.field("stick_timeout_s", stick_timeout_s, Range{0.05, 1},
            "rates are zeroed this long after the last stick command");
    v.field("stick_dead_band", stick_dead_band, Range{0, 1},
            "stick rates below this do not interrupt a mission [m/s, rad/s]");
    v.field("max_message_age_s", max_message_age_s, Range{0.05, 5},
            "messages that were longer on the way than the session's quickest by this are refused");
    v.field("max_messages_per_s", max_messages_per_s, Range{10, 10000},
            "commands and mission pieces taken from one session");
  }
};

}  // namespace tautline
