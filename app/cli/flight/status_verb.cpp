/// @file
/// `tautline status`: what the station is doing, why, and what keeps it on the ground.

#include <memory>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "app/cli/flight/verbs.h"
#include "app/cli/termination.h"
#include "app/station/events.h"
#include "app/station/vehicle_signs.h"
#include "common/estimate.h"
#include "common/vehicle.h"

namespace tautline::cli::flight {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

constexpr const char* kName = "status";
constexpr ConditionSet kArmingChecks = conditionsOf(ConditionKind::kForbidsArming);

/// What keeps the station from arming. A free lease does not: `arm` takes it.
ConditionSet blockers(const StationClient::View& v) {
  ConditionSet set = bitsOf(v.state->conditions) & kArmingChecks;
  if (v.authority && v.authority->session == 0) set.set(Condition::kNoOperator, false);
  return set;
}

/// The words of QGroundControl's main status indicator, for operators who know it.
const char* statusWord(const StationClient& client) {
  const auto& v = client.view();
  if (client.silent()) return "Communication Lost";
  switch (modeOf(*v.state)) {
    case Mode::kStandby:
      return blockers(v).empty() ? "Ready To Fly" : "Not Ready";
    case Mode::kArmed:
      return "Armed";
    case Mode::kLand:
    case Mode::kDescend:
      return "Landing";
    case Mode::kEstop:
      return "Not Ready";
    default:
      return "Flying";
  }
}

bool isMeasured(const StationClient::View& v, const ConditionInfo& info) {
  return v.safety && *info.unit != '\0';
}

/// "1.20 s (limit 0.50 s)", or nothing where it is not measured.
std::string measured(const StationClient::View& v, const ConditionInfo& info) {
  if (!isMeasured(v, info)) return "";
  const auto i = static_cast<std::size_t>(info.condition);
  return fmt::format("{:.4g} {} (limit {:.4g} {})", v.safety->value[i], info.unit,
                     v.safety->limit[i], info.unit);
}

json jsonOf(const StationClient::View& v, const ConditionInfo& info) {
  json row{{"name", info.name}, {"text", info.text}, {"remedy", info.remedy}};
  const auto i = static_cast<std::size_t>(info.condition);
  if (isMeasured(v, info)) {
    row["value"] = v.safety->value[i];
    row["limit"] = v.safety->limit[i];
    row["unit"] = info.unit;
  }
  return row;
}

const char* healthOf(const StationClient::View& v) {
  return nameOf(static_cast<EstimateHealth>(v.estimate->health), kEstimateHealthNames);
}
const char* phaseOf(const StationClient::View& v) {
  return nameOf(static_cast<VehiclePhase>(v.vehicle->phase), kVehiclePhaseNames);
}
const char* runModeOf(const StationClient::View& v) {
  return nameOf(static_cast<RunMode>(v.state->run_mode), kRunModeNames);
}

/// Flags that are set, by name.
std::vector<std::string> flagNames(const tautline::vehicle_state_t& v) {
  std::vector<std::string> names;
  for (const VehicleSign& flag : flagsOf(static_cast<VehicleProtocol>(v.protocol)))
    if ((v.flags & flag.code) != 0) names.emplace_back(flag.name);
  return names;
}
/// Name of the flight mode, or its number where the table does not have it.
std::string flightModeOf(const tautline::vehicle_state_t& v) {
  for (const VehicleSign& mode : modesOf(static_cast<VehicleProtocol>(v.protocol)))
    if (mode.code == v.flight_mode) return mode.name;
  return fmt::format("mode {}", v.flight_mode);
}

json linkOf(const tautline::vehicle_state_t& v) {
  return {{"place", v.link_place},
          {"connected", v.link_connected != 0},
          {"bytes_in", v.link_bytes_in},
          {"bytes_out", v.link_bytes_out},
          {"lines_ok", v.link_lines_ok},
          {"lines_bad", v.link_lines_bad},
          {"bytes_dropped", v.link_bytes_dropped},
          {"reconnects", v.link_reconnects},
          {"repeated", v.link_repeated},
          {"wrong_sequence", v.link_wrong_sequence},
          {"check_errors", v.link_check_errors},
          {"timeouts", v.link_timeouts},
          {"bus_errors", v.link_bus_errors},
          {"bus_off", v.link_bus_off},
          {"frames_lost", v.link_frames_lost},
          {"frames_foreign", v.link_frames_foreign},
          {"no_buffer", v.link_no_buffer}};
}

json toJson(const StationClient& client) {
  const auto& v = client.view();
  const auto& p = v.estimate->position_m;
  json checks = json::array();
  for (const ConditionInfo& info : kConditionInfos)
    if (blockers(v).has(info.condition)) checks.push_back(jsonOf(v, info));
  json lease = json::object();
  if (v.authority) {
    lease = {{"holder", holderOf(*v.authority)},
             {"age_s", v.authority->lease_age_s},
             {"left_s", v.authority->lease_left_s}};
  }
  return {{"status", statusWord(client)},
          {"run_mode", runModeOf(v)},
          {"mode", modeName(*v.state)},
          {"conditions", describe(bitsOf(v.state->conditions))},
          {"reasons", describe(bitsOf(v.state->reasons))},
          {"arming_blockers", describe(blockers(v))},
          {"arming_checks", checks},
          {"lease", lease},
          {"estimate_health", healthOf(v)},
          {"position_m", {p[0], p[1], p[2]}},
          {"tether_length_m", v.tether->length_free_m + v.tether->length_static_m},
          {"tension_n", v.tether->tension_n},
          {"vehicle", phaseOf(v)},
          {"vehicle_mode", flightModeOf(*v.vehicle)},
          {"vehicle_flags", flagNames(*v.vehicle)},
          {"battery_v", v.vehicle->ground_battery_v},
          {"link_fault", nameOf(static_cast<LinkFault>(v.vehicle->link_fault), kLinkFaultNames)},
          {"link", linkOf(*v.vehicle)}};
}

std::string leaseText(const StationClient::View& v) {
  if (!v.authority) return "unknown";
  if (v.authority->session == 0) return "free";
  return fmt::format("{}, last heard {:.1f} s ago", holderOf(*v.authority),
                     v.authority->heartbeat_age_s);
}

std::string toText(const StationClient& client) {
  const auto& v = client.view();
  std::string text;
  const auto row = [&text](const char* name, const std::string& value) {
    text += fmt::format("{:<10} {}\n", name, value);
  };
  const ConditionSet in_the_way = blockers(v);
  const ConditionSet others = bitsOf(v.state->conditions).without(kArmingChecks);
  row("status", statusWord(client));
  row("mode",
      fmt::format("{} ({}){}", modeName(*v.state), runModeOf(v), becauseOf(v.state->reasons)));
  row("lease", leaseText(v));
  for (const ConditionInfo& info : kConditionInfos) {
    if (!in_the_way.has(info.condition)) continue;
    const std::string value = measured(v, info);
    row("check", fmt::format("{}: {}{}{}", info.name, info.text, value.empty() ? "" : ", ", value));
    row("", fmt::format("remedy: {}", info.remedy));
  }
  if (!others.empty()) row("besides", describe(others));
  const auto fault = static_cast<LinkFault>(v.vehicle->link_fault);
  if (fault != LinkFault::kNone) {
    const EventText& event = textOf(eventOf(fault));
    std::string told;
    appendText(told, fmt::format("{}; {}", event.text, event.remedy), v.vehicle->link_place);
    row("link", told);
  }
  const auto& p = v.estimate->position_m;
  row("position", fmt::format("x {:.2f}  y {:.2f}  z {:.2f} m, {}", p[0], p[1], p[2], healthOf(v)));
  row("tether", fmt::format("{:.2f} m out, {:.2f} N, {} contact(s)",
                            v.tether->length_free_m + v.tether->length_static_m,
                            v.tether->tension_n, v.tether->contact_count));
  row("vehicle", fmt::format("{} ({}), ground battery {:.1f} V", phaseOf(v),
                             flightModeOf(*v.vehicle), v.vehicle->ground_battery_v));
  for (const VehicleSign& flag : flagsOf(static_cast<VehicleProtocol>(v.vehicle->protocol))) {
    if ((v.vehicle->flags & flag.code) == 0) continue;
    row("flag", fmt::format("{}: {}; {}", flag.name, flag.text, flag.remedy));
  }
  return text;
}

/// Rewrites the screen twice a second until Ctrl-C.
ExitCode watch(StationClient& client) {
  endOnSignals();
  constexpr const char* kHome = "\033[H";
  constexpr const char* kClearLine = "\033[K";
  constexpr const char* kClearRest = "\033[J";
  fmt::print("\033[2J");
  while (!termination_requested) {
    std::string screen = kHome;
    for (const char c : toText(client))
      screen += c == '\n' ? kClearLine + std::string("\n") : std::string(1, c);
    fmt::print("{}{}", screen, kClearRest);
    std::fflush(stdout);
    client.waitUntil([] { return termination_requested.load(); }, milliseconds(500));
  }
  return ExitCode::kOk;
}

ExitCode run(const Options& options, double wait_s, bool watching) {
  StationClient client(options.lcm_url, Role::kListener);
  const auto& v = client.view();
  const auto complete = [&] {
    return v.state && v.estimate && v.tether && v.vehicle && v.authority && v.safety;
  };
  const auto enough = [&] { return v.state && v.estimate && v.tether && v.vehicle; };
  if (!client.waitUntil(complete, milliseconds(static_cast<std::int64_t>(wait_s * 1000.0))) &&
      !enough())
    return noStation(options, kName);
  if (watching) return watch(client);
  fmt::print("{}", options.json ? toJson(client).dump() + "\n" : toText(client));
  return ExitCode::kOk;
}

}  // namespace

void addStatusVerb(CLI::App& root, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  const auto wait_s = std::make_shared<double>(5.0);
  const auto watching = std::make_shared<bool>(false);
  CLI::App* verb =
      addVerb(root, kName, "What the station is doing, why, and what keeps it on the ground",
              "tautline status --watch", *options);
  verb->add_option("--wait", *wait_s, "how long to wait for a station [s]")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 3600.0));
  verb->add_flag("--watch", *watching, "a live screen, until Ctrl-C");
  verb->callback([options, wait_s, watching, &result] {
    result = run(*options, *wait_s, *watching && !options->json);
  });
}

}  // namespace tautline::cli::flight
