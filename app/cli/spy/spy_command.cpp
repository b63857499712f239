#include "app/cli/spy/spy_command.h"

#include <poll.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Validators.hpp>
#include <fmt/format.h>
#include <lcm/lcm-cpp.hpp>

#include "app/cli/channel_filter.h"
#include "app/cli/spy/channel_board.h"
#include "app/cli/spy/spy_gui.h"
#include "app/cli/spy/spy_screen.h"
#include "app/cli/spy/terminal.h"
#include "app/cli/termination.h"
#include "common/clock.h"
#include "lcmtypes/lcm_access.h"

namespace tautline::cli {
namespace {

struct Options {
  std::string filter;
  double seconds{2.0};
  bool once{false};
  bool json{false};
  bool gui{false};
  std::string lcm_url{kDefaultLcmUrl};
};

constexpr Duration kRefresh = std::chrono::milliseconds(200);
constexpr int kQueueCapacity = 10'000;

/// Hears every channel.
class Ear {
 public:
  /// @throws InputError if LCM cannot work on this machine.
  explicit Ear(const std::string& url) : lcm_(reachable(url)) {
    if (!lcm_.good()) throw cannotJoin(url);
    lcm_.subscribe(".*", &Ear::onMessage, this)->setQueueCapacity(kQueueCapacity);
  }

  /// Handles what comes until `end`, or until a key is typed (`keys`) or the program is to end.
  void listen(Time end, bool keys) {
    std::array<pollfd, 2> in{
        {{lcm_.getFileno(), POLLIN, 0}, {keys ? STDIN_FILENO : -1, POLLIN, 0}}};
    while (!termination_requested) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - monotonicNow());
      if (left.count() <= 0) return;
      if (::poll(in.data(), in.size(), static_cast<int>(left.count())) <= 0) continue;
      if (in[0].revents != 0) lcm_.handleTimeout(0);
      if (in[1].revents != 0) return;
    }
  }

  [[nodiscard]] const ChannelBoard& board() const noexcept { return board_; }

 private:
  void onMessage(const lcm::ReceiveBuffer* bytes, const std::string& channel) {
    board_[channel].add({static_cast<const std::uint8_t*>(bytes->data), bytes->data_size},
                        monotonicNow());
  }

  lcm::LCM lcm_;
  ChannelBoard board_;
};

void print(const Options& options, const ChannelBoard& board) {
  const ChannelFilter filter(options.filter, "--filter");
  const Time now = monotonicNow();
  DecodedMessage channels = DecodedMessage::array();
  if (!options.json) fmt::print("{}\n", SpyScreen::header());
  for (const auto& [name, channel] : board) {
    if (!filter.matches(name)) continue;
    if (options.json) {
      channels.push_back(jsonOf(name, channel, now));
    } else {
      fmt::print("{}\n", SpyScreen::row(name, channel, now));
    }
  }
  if (options.json)
    fmt::print("{}\n", DecodedMessage{{"verb", "spy"}, {"channels", channels}}.dump(
                           -1, ' ', false, DecodedMessage::error_handler_t::replace));
  std::fflush(stdout);
}

/// Prints once, or every --for seconds until the program is told to end.
ExitCode printing(const Options& options) {
  static_cast<void>(ChannelFilter(options.filter, "--filter"));  // refused before waiting
  Ear ear(options.lcm_url);
  do {
    ear.listen(monotonicNow() + fromSeconds(options.seconds), false);
    print(options, ear.board());
  } while (!options.once && !termination_requested);
  return ear.board().empty() ? ExitCode::kTimeout : ExitCode::kOk;
}

ExitCode interactive(const Options& options) {
  SpyScreen screen(options.lcm_url, options.filter);
  Ear ear(options.lcm_url);
  Terminal terminal;
  while (!screen.done() && !termination_requested) {
    terminal.show(screen.draw(ear.board(), monotonicNow(), terminal.size()));
    ear.listen(monotonicNow() + kRefresh, true);
    for (int pressed = terminal.readKey(); pressed != key::kNone && !screen.done();
         pressed = terminal.readKey())
      screen.onKey(pressed, ear.board(), monotonicNow());
  }
  return ExitCode::kOk;
}

ExitCode run(const Options& options) {
  if (options.gui) becomeLcmSpy(options.lcm_url);
  endOnSignals();
  return options.once || options.json ? printing(options) : interactive(options);
}

}  // namespace

void addSpyCommand(CLI::App& root, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb =
      root.add_subcommand("spy", "Every LCM channel: rate, bandwidth, age, jitter, decoded fields");
  verb->add_option("--filter", options->filter,
                   "Only channels in whose name this regular expression is found")
      ->type_name("RE");
  verb->add_flag("--once", options->once,
                 "Print one table (or JSON object) and end; 4: nothing heard");
  verb->add_flag("--json", options->json, "JSON objects instead of the screen");
  verb->add_option("--for", options->seconds, "Listen so many seconds for each table")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  verb->add_flag("--gui", options->gui, "Start Debian's lcm-spy with Tautline's types (needs Java)")
      ->excludes("--once")
      ->excludes("--json");
  verb->add_option("--lcm-url", options->lcm_url, "Where the station is")->capture_default_str();
  verb->footer(
      "Example: tautline spy --filter 'ESTIMATE|TETHER'\n"
      "         tautline spy --json --once --for 2\n"
      "Keys: up, down, Enter fields, Esc back, / filter, p pause, q quit.");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace tautline::cli
