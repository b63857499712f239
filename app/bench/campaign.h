#pragma once

/// @file
/// The safety campaign: every fault of a table in every phase of a flight, and pairs of them
/// (docs/fault_campaign.md). The table is data: config/scenarios/campaign.toml.

#include <string>
#include <vector>

#include "app/bench/flight_case.h"

namespace tautline::bench {

/// A phase in which faults begin.
struct CampaignPhase {
  Mode mode{};
  Duration at{};     ///< After the mode was first entered.
  Duration limit{};  ///< Of the whole flight.
  bool pairs{false};
  Request ask{Request::kNone};  ///< How the operator gets there out of the mission; kNone: anyway.
  Duration ask_at{};            ///< After AUTO began.
};

/// What the station owes in a situation: a row of the failsafe table (docs/supervisor.md).
struct Failsafe {
  std::string name;       ///< Unique.
  ConditionSet detect;    ///< One of these is raised ...
  Duration detect_in{};   ///< ... within this time ...
  ModeSet detect_phases;  ///< ... if the fault begins in one of these.
  ModeSet react;          ///< Into one of these modes ...
  Duration react_in{};    ///< ... within this time ...
  ModeSet react_phases;   ///< ... if the fault begins in one of these.
  ModeSet end;            ///< The flight ends in one of these.
};

/// One row of the table: a fault and what is expected of a flight that has it.
struct CampaignRow {
  std::string label;                 ///< Unique.
  sim::Fault fault;                  ///< `at` is not used.
  std::vector<std::string> flights;  ///< Names; empty: all whose device can have it.
  ModeSet phases;                    ///< Empty: all.
  bool pairs{false};                 ///< Also together with the other rows that have this.
  Failsafe owed;                     ///< Without detect and react: to be flown through.
  bool may_crash{false};             ///< It may end so, and no station could prevent it.
  bool landed{true};                 ///< Ends on the ground, motors off.
};

struct Campaign {
  std::uint64_t seed{1};
  std::vector<FlightCase> flights;  ///< Without faults.
  std::vector<CampaignPhase> phases;
  std::vector<CampaignRow> rows;
};

/// Throws InputError.
[[nodiscard]] Campaign readCampaign(const std::string& file);

/// One case of the campaign, small enough to have all of them in memory.
struct CampaignCase {
  std::string name;  ///< "flight/PHASE/fault [+ fault]", unique.
  std::size_t flight{0};
  std::size_t phase{0};
  std::size_t first{0};               ///< Row.
  std::optional<std::size_t> second;  ///< Row of a pair.
};

/// All of them, always in the same order.
[[nodiscard]] std::vector<CampaignCase> campaignCases(const Campaign& campaign);

/// The flight of a case. Its seed comes from the campaign's seed and the case's name.
[[nodiscard]] FlightCase flightOf(const Campaign& campaign, const CampaignCase& c);

}  // namespace tautline::bench
