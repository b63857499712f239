/// @file
/// `tautline navigate FILE`: sends a mission, flies it and waits for its end.

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "app/cli/flight/verbs.h"
#include "common/mission/mission_check.h"
#include "common/mission/mission_file.h"
#include "control/motion_executor.h"

namespace tautline::cli::flight {
namespace {

using std::chrono::seconds;

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

ExitCode navigate(const Options& options, const std::string& file) {
  const Mission mission = readMission(file);
  requireFlyable(mission, file);
  StationClient client(options.lcm_url, Role::kOperator);
  printEvents(client, options);
  const auto loaded = client.upload(*mission.plan);
  if (!loaded)
    return finish(options, "navigate", ExitCode::kTimeout,
                  "no answer from a station while sending the mission");
  if (loaded->result != static_cast<std::int8_t>(AckResult::kAccepted)) {
    return finish(options, "navigate", ExitCode::kRefused, refusalText(*loaded, client));
  }
  if (const ExitCode code =
          ask(client, options, "navigate",
              {.request = Request::kNavigate, .mission_hash = mission.plan->hash});
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

}  // namespace

void addNavigateVerb(CLI::App& root, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  const auto file = std::make_shared<std::string>();
  CLI::App* verb = addVerb(root, "navigate", "Fly a mission file",
                           "tautline navigate config/missions/square.mission.toml", *options);
  addTimeout(*verb, *options);
  verb->add_option("file", *file, "mission file (*.mission.toml)")->required();
  verb->callback([options, file, &result] { result = navigate(*options, *file); });
}

}  // namespace tautline::cli::flight
