#include "app/cli/flight_command.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/station_client.h"
#include "app/station/events.h"
#include "common/estimate.h"
#include "common/mission/mission_check.h"
#include "common/mission/mission_file.h"
#include "common/vehicle.h"
#include "control/motion_executor.h"
#include "lcmtypes/channels.h"

namespace tautline::cli {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Options {
  std::string lcm_url{kDefaultLcmUrl};
  bool json{false};
  bool quiet{false};
  double timeout_s{0.0};  ///< 0: the verb's own.
  double wait_s{5.0};     ///< status: how long to wait for a station.
  std::string mission_file;
};

Mode modeOf(const tautline::station_state_t& state) { return static_cast<Mode>(state.mode); }
const char* modeName(const tautline::station_state_t& state) {
  return nameOf(modeOf(state), kModeNames);
}
ConditionSet bitsOf(std::int64_t bits) {
  return ConditionSet::fromBits(static_cast<std::uint64_t>(bits));
}

/// Prints one line: words for people, or one JSON object.
void say(const Options& options, const char* verb, ExitCode code, const std::string& text,
         nlohmann::json extra = {}) {
  if (options.json) {
    nlohmann::json out{{"verb", verb},
                       {"ok", code == ExitCode::kOk},
                       {"exit_code", static_cast<int>(code)},
                       {"text", text}};
    if (extra.is_object()) out.update(extra);
    fmt::print("{}\n", out.dump());
  } else if (code == ExitCode::kOk) {
    if (!options.quiet) fmt::print("{}: {}\n", verb, text);
  } else {
    fmt::print(stderr, "tautline: {}: {}\n", verb, text);
  }
}

ExitCode finish(const Options& options, const char* verb, ExitCode code, const std::string& text) {
  say(options, verb, code, text);
  return code;
}

/// " because of …", or nothing.
std::string becauseOf(std::int64_t bits) {
  const std::string reasons = describe(bitsOf(bits));
  return reasons.empty() ? "" : " because of " + reasons;
}

constexpr const char* kSilent = "the station has fallen silent; it may still fly, look at it";

void printEvents(StationClient& client, const Options& options) {
  if (options.json || options.quiet) return;
  client.onEvent([](const tautline::event_t& e) {
    fmt::print("  {}{}{}{}{}\n", e.text, e.reaction.empty() ? "" : " -> ", e.reaction,
               e.remedy.empty() ? "" : "; ", e.remedy);
    std::fflush(stdout);
  });
}

std::string refusalText(const tautline::command_ack_t& ack, const StationClient& client) {
  std::string text = nameOf(static_cast<AckResult>(ack.result), kAckResultNames);
  const std::string reasons = describe(bitsOf(ack.reasons));
  if (!reasons.empty()) return text + " because of " + reasons + "; see `tautline status`";
  if (client.view().state) text += std::string(" in mode ") + modeName(*client.view().state);
  return text;
}

/// Sends the request; kOk if accepted, otherwise the exit code, after saying why.
ExitCode ask(StationClient& client, const Options& options, const char* verb, Request request,
             std::uint64_t mission_hash = 0) {
  const auto ack = client.request(request, mission_hash);
  if (!ack) {
    return finish(options, verb, ExitCode::kTimeout,
                  "no answer from a station; is tautline-station running with --lcm-url " +
                      options.lcm_url + "?");
  }
  if (ack->result != static_cast<std::int8_t>(AckResult::kAccepted)) {
    return finish(options, verb, ExitCode::kRefused, refusalText(*ack, client));
  }
  return ExitCode::kOk;
}

milliseconds limitOf(const Options& options, seconds fallback) {
  return options.timeout_s > 0.0
             ? milliseconds(static_cast<std::int64_t>(options.timeout_s * 1000.0))
             : milliseconds(fallback);
}

/// Sends the request and waits for `goal`; any other mode than those passed through on the way ends
/// the wait.
ExitCode goToMode(const Options& options, const char* verb, Request request, Mode goal,
                  seconds patience) {
  StationClient client(options.lcm_url);
  printEvents(client, options);
  if (const ExitCode code = ask(client, options, verb, request); code != ExitCode::kOk) return code;
  const Mode passing = request == Request::kTakeoff ? Mode::kTakeoff
                       : request == Request::kLand  ? Mode::kLand
                                                    : goal;
  bool seen = false;
  const auto settled = [&] {
    if (client.silent()) return true;
    if (!client.view().state) return false;
    const Mode mode = modeOf(*client.view().state);
    seen = seen || mode == passing || mode == goal;
    return seen && (mode == goal || mode != passing);
  };
  if (!client.waitUntil(settled, limitOf(options, patience))) {
    return finish(options, verb, ExitCode::kTimeout, "accepted, but not done in time");
  }
  if (client.silent()) return finish(options, verb, ExitCode::kTimeout, kSilent);
  const auto& state = *client.view().state;
  if (modeOf(state) == goal)
    return finish(options, verb, ExitCode::kOk, std::string("done, mode ") + modeName(state));
  return finish(options, verb, ExitCode::kFailed,
                std::string("ended in mode ") + modeName(state) + becauseOf(state.reasons));
}

const char* failureName(const tautline::mission_status_t& status) {
  return nameOf(static_cast<MissionFailure>(status.failure), kMissionFailureNames);
}

/// One line that is rewritten in a terminal.
void showProgress(const tautline::mission_status_t& m) {
  fmt::print("\r  waypoint {:>3}/{:<3}  {:5.2f} m to go  cross-track {:4.2f} m ", m.waypoint + 1,
             m.waypoint_count, m.distance_m, m.cross_track_m);
  std::fflush(stdout);
}

/// @throws InputError with the first thing that makes the mission unflyable, before any of it is
/// sent.
void requireFlyable(const Mission& mission, const std::string& file) {
  // The map may be on another machine than this client: then only what needs no map is checked.
  const bool has_map =
      std::filesystem::exists(std::filesystem::path(file).parent_path() / mission.map);
  const std::optional<Scene> scene = has_map ? findScene(mission, file) : std::nullopt;
  for (const MissionFinding& finding :
       checkMission(mission, MissionLimits{}, scene ? &*scene : nullptr)) {
    if (finding.severity != FindingSeverity::kError) continue;
    throw InputError({.file = file,
                      .key = finding.row,
                      .problem = finding.text,
                      .remedy = finding.remedy + "; all findings: tautline mission check " + file});
  }
}

ExitCode navigate(const Options& options) {
  const Mission mission = readMission(options.mission_file);
  requireFlyable(mission, options.mission_file);
  StationClient client(options.lcm_url);
  printEvents(client, options);
  const auto loaded = client.upload(*mission.plan);
  if (!loaded)
    return finish(options, "navigate", ExitCode::kTimeout,
                  "no answer from a station while sending the mission");
  if (loaded->result != static_cast<std::int8_t>(AckResult::kAccepted)) {
    return finish(options, "navigate", ExitCode::kRefused, refusalText(*loaded, client));
  }
  if (const ExitCode code =
          ask(client, options, "navigate", Request::kNavigate, mission.plan->hash);
      code != ExitCode::kOk) {
    return code;
  }
  const auto hash = static_cast<std::int64_t>(mission.plan->hash);
  const bool live = !options.json && !options.quiet && isatty(STDOUT_FILENO) != 0;
  bool flying = false;
  const auto ended = [&] {
    if (client.silent()) return true;
    const auto& v = client.view();
    if (!v.state || !v.mission || v.mission->mission_hash != hash) return false;
    const auto state = static_cast<MissionState>(v.mission->state);
    flying = flying || (modeOf(*v.state) == Mode::kAuto && state != MissionState::kCompleted);
    if (flying && live) showProgress(*v.mission);
    return flying && modeOf(*v.state) != Mode::kAuto;
  };
  const bool in_time = client.waitUntil(ended, limitOf(options, seconds(3600)));
  if (live) fmt::print("\n");
  if (!in_time)
    return finish(options, "navigate", ExitCode::kTimeout,
                  "mission not ended in time; the station goes on");
  if (client.silent()) return finish(options, "navigate", ExitCode::kTimeout, kSilent);
  const auto& status = *client.view().mission;
  const nlohmann::json extra{{"waypoint", status.waypoint},
                             {"waypoint_count", status.waypoint_count}};
  if (static_cast<MissionState>(status.state) == MissionState::kCompleted) {
    say(options, "navigate", ExitCode::kOk,
        fmt::format("mission {} completed, {} waypoints", mission.name, status.waypoint_count),
        extra);
    return ExitCode::kOk;
  }
  say(options, "navigate", ExitCode::kFailed,
      fmt::format("mission ended at waypoint {} of {} in mode {}: {} {}", status.waypoint + 1,
                  status.waypoint_count, modeName(*client.view().state), failureName(status),
                  describe(bitsOf(client.view().state->reasons))),
      extra);
  return ExitCode::kFailed;
}

nlohmann::json linkCounters(const tautline::vehicle_state_t& v) {
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

ExitCode status(const Options& options) {
  StationClient client(options.lcm_url);
  const auto& v = client.view();
  const auto complete = [&] { return v.state && v.estimate && v.tether && v.vehicle; };
  if (!client.waitUntil(complete,
                        milliseconds(static_cast<std::int64_t>(options.wait_s * 1000.0)))) {
    return finish(
        options, "status", ExitCode::kTimeout,
        "no station heard; is tautline-station running with --lcm-url " + options.lcm_url + "?");
  }
  const char* run_mode = nameOf(static_cast<RunMode>(v.state->run_mode), kRunModeNames);
  const char* health =
      nameOf(static_cast<EstimateHealth>(v.estimate->health), kEstimateHealthNames);
  const char* phase = nameOf(static_cast<VehiclePhase>(v.vehicle->phase), kVehiclePhaseNames);
  const std::string conditions = describe(bitsOf(v.state->conditions));
  const auto fault = static_cast<LinkFault>(v.vehicle->link_fault);
  if (options.json) {
    const auto& p = v.estimate->position_m;
    fmt::print("{}\n", nlohmann::json{{"run_mode", run_mode},
                                      {"mode", modeName(*v.state)},
                                      {"conditions", conditions},
                                      {"reasons", describe(bitsOf(v.state->reasons))},
                                      {"estimate_health", health},
                                      {"position_m", {p[0], p[1], p[2]}},
                                      {"tether_length_m",
                                       v.tether->length_free_m + v.tether->length_static_m},
                                      {"tension_n", v.tether->tension_n},
                                      {"vehicle", phase},
                                      {"battery_v", v.vehicle->ground_battery_v},
                                      {"link_fault", nameOf(fault, kLinkFaultNames)},
                                      {"link", linkCounters(*v.vehicle)}}
                           .dump());
    return ExitCode::kOk;
  }
  fmt::print("{:<10} {} ({})\n", "mode", modeName(*v.state), run_mode);
  fmt::print("{:<10} {}\n", "conditions", conditions.empty() ? "none" : conditions);
  if (fault != LinkFault::kNone) {
    const EventText& text = textOf(eventOf(fault));
    std::string told;
    appendText(told, fmt::format("{}; {}", text.text, text.remedy), v.vehicle->link_place);
    fmt::print("{:<10} {}\n", "link", told);
  }
  fmt::print("{:<10} x {:.2f}  y {:.2f}  z {:.2f} m, {}\n", "position", v.estimate->position_m[0],
             v.estimate->position_m[1], v.estimate->position_m[2], health);
  fmt::print("{:<10} {:.2f} m out, {:.2f} N, {} contact(s)\n", "tether",
             v.tether->length_free_m + v.tether->length_static_m, v.tether->tension_n,
             v.tether->contact_count);
  fmt::print("{:<10} {}, ground battery {:.1f} V\n", "vehicle", phase, v.vehicle->ground_battery_v);
  return ExitCode::kOk;
}

}  // namespace

void addFlightCommands(CLI::App& root, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  const auto add = [&root, options](const char* name, const char* text, const char* example) {
    CLI::App* verb = root.add_subcommand(name, text);
    verb->add_option("--lcm-url", options->lcm_url, "where the station is")->capture_default_str();
    verb->add_flag("--json", options->json, "one JSON object instead of words");
    verb->add_flag("--quiet", options->quiet, "say nothing when all is well");
    verb->footer(std::string("Example: ") + example);
    return verb;
  };
  const auto withTimeout = [options](CLI::App* verb) {
    verb->add_option("--timeout", options->timeout_s, "give up waiting after this many seconds")
        ->check(CLI::Range(0.1, 86400.0));
    return verb;
  };

  CLI::App* status_verb = add("status", "What the station is doing", "tautline status --json");
  status_verb->add_option("--wait", options->wait_s, "how long to wait for a station [s]")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 3600.0));
  status_verb->callback([options, &result] { result = status(*options); });

  struct Verb {
    const char* name;
    const char* text;
    const char* example;
    Request request;
    Mode goal;
    int patience_s;
  };
  constexpr Verb kVerbs[] = {
      {"arm", "Make the station ready for take-off", "tautline arm", Request::kArm, Mode::kArmed,
       5},
      {"disarm", "Back to STANDBY on the ground; also clears a stop", "tautline disarm",
       Request::kDisarm, Mode::kStandby, 5},
      {"takeoff", "Take off and hover above home", "tautline takeoff --timeout 60",
       Request::kTakeoff, Mode::kHold, 60},
      {"hold", "Hover where it is; ends a mission", "tautline hold", Request::kHold, Mode::kHold,
       5},
      {"land", "Go home, land and stop the motors", "tautline land", Request::kLand, Mode::kStandby,
       180},
      {"stop", "Stand still now; nothing moves until the next command", "tautline stop",
       Request::kStop, Mode::kFailsafe, 5},
      {"estop", "Motors off at once. The drone falls", "tautline estop", Request::kEstop,
       Mode::kEstop, 5},
  };
  for (const Verb& v : kVerbs) {
    withTimeout(add(v.name, v.text, v.example))->callback([options, &result, v] {
      result = goToMode(*options, v.name, v.request, v.goal, seconds(v.patience_s));
    });
  }

  CLI::App* nav = withTimeout(add("navigate", "Fly a mission file",
                                  "tautline navigate config/missions/square.mission.toml"));
  nav->add_option("file", options->mission_file, "mission file (*.mission.toml)")->required();
  nav->callback([options, &result] { result = navigate(*options); });
}

}  // namespace tautline::cli
