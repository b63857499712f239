/// @file
/// `tautline teleop`: flies by the keyboard, or by a script of timed rates. Whatever ends it, the
/// drone is told to hold.

#include <csignal>
#include <cstdio>
#include <functional>
#include <memory>

#include <fmt/format.h>

#include "app/cli/flight/keyboard.h"
#include "app/cli/flight/stick_script.h"
#include "app/cli/flight/verbs.h"
#include "common/clock.h"

namespace tautline::cli::flight {
namespace {

using std::chrono::milliseconds;

constexpr const char* kName = "teleop";
constexpr milliseconds kStickPeriod{50};

volatile std::sig_atomic_t interrupted = 0;

struct StickState {
  bool dead_man{false};
  TeleopRates rates;
};

/// Where the sticks are now; none: the operator, or the terminal, has ended it.
using StickSource = std::function<std::optional<StickState>(Time now)>;

void catchSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, [](int) { interrupted = 1; });
  std::signal(SIGPIPE, SIG_IGN);
}

StickSource keyboard(const RawTerminal& terminal) {
  auto sticks = std::make_shared<KeyboardSticks>();
  return [&terminal, sticks](Time now) -> std::optional<StickState> {
    const auto keys = terminal.read();
    if (!keys) return std::nullopt;
    for (const char key : *keys) sticks->press(key, now);
    sticks->update(now);
    if (sticks->wantsToEnd()) return std::nullopt;
    return StickState{sticks->deadManHeld(), sticks->rates()};
  };
}

StickSource script(const std::vector<StickRow>& rows) {
  return [&rows, start = std::optional<Time>{}](Time now) mutable -> std::optional<StickState> {
    if (!start) start = now;
    const auto row = rowAt(rows, now - *start);
    if (!row) return std::nullopt;
    return StickState{row->dead_man, row->rates};
  };
}

/// One line that is rewritten. Never throws: the terminal may be gone.
void show(const StationClient& client, const StickState& sticks) {
  std::string line = sticks.dead_man ? "\r FLYING " : "\r space? ";
  for (const StickKeys& stick : kSticks)
    line += fmt::format(" {} {:+.2f}", stick.name, sticks.rates.*stick.rate);
  const auto& v = client.view();
  if (v.state) line += fmt::format("  {}", modeName(*v.state));
  if (v.estimate) {
    const auto& p = v.estimate->position_m;
    line += fmt::format("  at {:.2f} {:.2f} {:.2f} m", p[0], p[1], p[2]);
  }
  std::fputs((line + "\033[K").c_str(), stdout);
  std::fflush(stdout);
}

enum class End { kOperator, kStation, kSilent };

End fly(StationClient& client, const Options& options, const StickSource& source) {
  const auto inTeleop = [&] { return modeOf(*client.view().state) == Mode::kTeleop; };
  const bool shows = !options.json && !options.quiet;
  while (interrupted == 0) {
    const auto sticks = source(monotonicNow());
    if (!sticks) return End::kOperator;
    client.sendSticks(sticks->dead_man, sticks->rates);
    if (shows) show(client, *sticks);
    client.waitUntil([] { return interrupted != 0; }, kStickPeriod);
    if (client.silent()) return End::kSilent;
    if (!inTeleop()) return End::kStation;
  }
  return End::kOperator;
}

ExitCode run(const Options& options, const std::string& script_file) {
  const std::vector<StickRow> rows =
      script_file.empty() ? std::vector<StickRow>{} : readStickScript(script_file);
  std::optional<RawTerminal> terminal;
  if (script_file.empty()) terminal.emplace();
  StationClient client(options.lcm_url, Role::kOperator);
  catchSignals();
  if (const ExitCode code = ask(client, options, kName, {.request = Request::kTeleop});
      code != ExitCode::kOk)
    return code;
  const auto begun = [&] {
    return client.view().state && modeOf(*client.view().state) == Mode::kTeleop;
  };
  if (!client.waitUntil(begun, std::chrono::seconds(3)))
    return finish(options, kName, ExitCode::kTimeout, "accepted, but no TELEOP in time");

  const End end = fly(client, options, terminal ? keyboard(*terminal) : script(rows));
  client.sendSticks(false, {});
  const auto held = end == End::kOperator ? client.send({.request = Request::kHold}) : std::nullopt;
  terminal.reset();
  if (!options.json && !options.quiet) std::fputs("\n", stdout);
  if (end == End::kSilent) return finish(options, kName, ExitCode::kTimeout, kSilent);
  if (end == End::kStation) {
    const auto& state = *client.view().state;
    return finish(options, kName, ExitCode::kFailed,
                  std::string("ended in mode ") + modeName(state) + becauseOf(state.reasons));
  }
  if (!held || held->result != static_cast<std::int8_t>(AckResult::kAccepted))
    return finish(options, kName, ExitCode::kFailed,
                  "ended, and HOLD was not acknowledged; the station stands still by itself");
  return finish(options, kName, ExitCode::kOk, "ended, holding");
}

std::string keysHelp() {
  std::string text = "Example: tautline teleop\nKeys:";
  for (const StickKeys& s : kSticks)
    text += fmt::format("\n  {} {}    {} up and down in steps of {} {}, at most {}", s.up, s.down,
                        s.name, s.step, s.unit, s.most);
  return text +
         "\n  space  held: the sticks count; released: zero rates, sticks to the middle"
         "\n  x      sticks to the middle"
         "\n  Ctrl-C, Ctrl-D, Escape: hold and end. So does a terminal that is lost.";
}

}  // namespace

void addTeleopVerb(CLI::App& root, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  const auto file = std::make_shared<std::string>();
  CLI::App* verb =
      addVerb(root, kName, "Fly by the keyboard; ends in HOLD", "tautline teleop", *options);
  verb->add_option("--script", *file,
                   "timed rates instead of the keyboard: seconds dead_man length elevation azimuth "
                   "yaw gimbal, a row a line")
      ->type_name("FILE");
  verb->footer(keysHelp());
  verb->callback([options, file, &result] { result = run(*options, *file); });
}

}  // namespace tautline::cli::flight
