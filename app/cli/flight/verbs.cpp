#include "app/cli/flight/verbs.h"

#include <cstdio>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>

#include "app/station/events.h"

namespace tautline::cli::flight {

using std::chrono::milliseconds;

CLI::App* addVerb(CLI::App& parent, const char* name, const char* text, const char* example,
                  Options& options) {
  CLI::App* verb = parent.add_subcommand(name, text);
  verb->add_option("--lcm-url", options.lcm_url, "where the station is")->capture_default_str();
  verb->add_flag("--json", options.json, "one JSON object instead of words");
  verb->add_flag("--quiet", options.quiet, "say nothing when all is well");
  verb->footer(std::string("Example: ") + example);
  return verb;
}

void addTimeout(CLI::App& verb, Options& options) {
  verb.add_option("--timeout", options.timeout_s, "give up waiting after this many seconds")
      ->check(CLI::Range(0.1, 86400.0));
}

void say(const Options& options, const char* verb, ExitCode code, const std::string& text,
         const nlohmann::json& extra) {
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

ExitCode noStation(const Options& options, const char* verb) {
  return finish(
      options, verb, ExitCode::kTimeout,
      "no station heard; is tautline-station running with --lcm-url " + options.lcm_url + "?");
}

std::string becauseOf(std::int64_t bits) {
  const std::string reasons = describe(bitsOf(bits));
  return reasons.empty() ? "" : " because of " + reasons;
}

std::string holderOf(const tautline::authority_t& authority) {
  return authority.session == 0 ? "" : nameFromBytes(authority.name).data();
}

void printEvents(StationClient& client, const Options& options) {
  if (options.json || options.quiet) return;
  client.onEvent([](const tautline::event_t& e) {
    if (isAudit(static_cast<EventCode>(e.code))) return;
    fmt::print("  {}{}{}{}{}\n", e.text, e.reaction.empty() ? "" : " -> ", e.reaction,
               e.remedy.empty() ? "" : "; ", e.remedy);
    std::fflush(stdout);
  });
}

std::string refusalText(const tautline::command_ack_t& ack, StationClient& client) {
  const auto result = static_cast<AckResult>(ack.result);
  std::string text = nameOf(result, kAckResultNames);
  const auto& v = client.view();
  if (result == AckResult::kNotHolder) {
    client.waitUntil([&] { return v.authority.has_value(); }, std::chrono::seconds(1));
    if (v.authority && v.authority->session != 0)
      text = "the lease is held by " + holderOf(*v.authority);
    return text + "; ask for it, or `tautline lease take --force`";
  }
  const std::string reasons = describe(bitsOf(ack.reasons));
  if (!reasons.empty()) return text + " because of " + reasons + "; see `tautline status`";
  if (result == AckResult::kOutOfMode && v.state)
    return text + std::string(" in mode ") + modeName(*v.state);
  return text;
}

ExitCode ask(StationClient& client, const Options& options, const char* verb,
             const OperatorCommand& command) {
  const auto ack = client.send(command);
  if (!ack) return noStation(options, verb);
  if (ack->result != static_cast<std::int8_t>(AckResult::kAccepted))
    return finish(options, verb, ExitCode::kRefused, refusalText(*ack, client));
  return ExitCode::kOk;
}

milliseconds limitOf(const Options& options, std::chrono::seconds fallback) {
  return options.timeout_s > 0.0
             ? milliseconds(static_cast<std::int64_t>(options.timeout_s * 1000.0))
             : milliseconds(fallback);
}

}  // namespace tautline::cli::flight
