/// @file
/// `tautline arm|disarm|takeoff|hold|backup|return|land|stop|estop`: verbs that end in a mode.

#include <memory>

#include "app/cli/flight/verbs.h"

namespace tautline::cli::flight {
namespace {

struct Verb {
  const char* name;
  const char* text;
  const char* example;
  Request request;
  Mode passing;  ///< Mode on the way.
  Mode goal;
  int patience_s;
};

constexpr Verb kVerbs[] = {
    {"arm", "Make the station ready for take-off", "tautline arm", Request::kArm, Mode::kArmed,
     Mode::kArmed, 5},
    {"disarm", "Back to STANDBY on the ground; also clears an emergency stop and latched faults",
     "tautline disarm", Request::kDisarm, Mode::kStandby, Mode::kStandby, 5},
    {"takeoff", "Take off and hover above home", "tautline takeoff --timeout 60", Request::kTakeoff,
     Mode::kTakeoff, Mode::kHold, 60},
    {"hold", "Hover where it is; ends a mission", "tautline hold", Request::kHold, Mode::kHold,
     Mode::kHold, 5},
    {"backup", "Go back along the flown path for a while, contacts undone in reverse order",
     "tautline backup", Request::kBackUp, Mode::kBackUp, Mode::kHold, 120},
    {"return", "Go back along the flown path to above home", "tautline return", Request::kReturn,
     Mode::kReturn, Mode::kHold, 600},
    {"land", "Go home, land and stop the motors", "tautline land", Request::kLand, Mode::kLand,
     Mode::kStandby, 180},
    {"stop", "Stand still now; nothing moves until the next command", "tautline stop",
     Request::kStop, Mode::kFailsafe, Mode::kFailsafe, 5},
    {"estop", "Motors off at once. The drone falls", "tautline estop", Request::kEstop,
     Mode::kEstop, Mode::kEstop, 5},
};

/// Sends the request and waits for the goal; any mode but that on the way ends the wait.
ExitCode run(const Options& options, const Verb& verb) {
  StationClient client(options.lcm_url, Role::kOperator);
  printEvents(client, options);
  if (const ExitCode code = ask(client, options, verb.name, {.request = verb.request});
      code != ExitCode::kOk)
    return code;
  bool seen = false;
  const auto settled = [&] {
    if (client.silent()) return true;
    if (!client.view().state) return false;
    const Mode mode = modeOf(*client.view().state);
    seen = seen || mode == verb.passing || mode == verb.goal;
    return seen && (mode == verb.goal || mode != verb.passing);
  };
  if (!client.waitUntil(settled, limitOf(options, std::chrono::seconds(verb.patience_s))))
    return finish(options, verb.name, ExitCode::kTimeout, "accepted, but not done in time");
  if (client.silent()) return finish(options, verb.name, ExitCode::kTimeout, kSilent);
  const auto& state = *client.view().state;
  if (modeOf(state) == verb.goal)
    return finish(options, verb.name, ExitCode::kOk, std::string("done, mode ") + modeName(state));
  return finish(options, verb.name, ExitCode::kFailed,
                std::string("ended in mode ") + modeName(state) + becauseOf(state.reasons));
}

}  // namespace

void addModeVerbs(CLI::App& root, ExitCode& result) {
  for (const Verb& verb : kVerbs) {
    const auto options = std::make_shared<Options>();
    CLI::App* added = addVerb(root, verb.name, verb.text, verb.example, *options);
    addTimeout(*added, *options);
    added->callback([options, &result, &verb] { result = run(*options, verb); });
  }
}

}  // namespace tautline::cli::flight
