#pragma once

/// @file
/// What the verbs that talk to a station have in common: options, one way to print, one way to ask.
/// Each verb, or family of verbs, is a file of its own.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>

#include "app/cli/station_client.h"
#include "common/error.h"
#include "lcmtypes/channels.h"
#include "supervision/condition.h"
#include "supervision/supervisor.h"

namespace tautline::cli::flight {

/// @name One for each verb: adds it to `root`; when it ran, `result` holds its exit code
/// @{
void addStatusVerb(CLI::App& root, ExitCode& result);
void addModeVerbs(CLI::App& root, ExitCode& result);
void addNavigateVerb(CLI::App& root, ExitCode& result);
void addTeleopVerb(CLI::App& root, ExitCode& result);
void addLeaseVerb(CLI::App& root, ExitCode& result);
void addParamVerb(CLI::App& root, ExitCode& result);
void addFaultsVerb(CLI::App& root, ExitCode& result);
void addHelpVerb(CLI::App& root, ExitCode& result);
/// @}

struct Options {
  std::string lcm_url{kDefaultLcmUrl};
  bool json{false};
  bool quiet{false};
  double timeout_s{0.0};  ///< 0: the verb's own.
};

/// Adds a verb with the options that all have, and its example.
CLI::App* addVerb(CLI::App& parent, const char* name, const char* text, const char* example,
                  Options& options);
void addTimeout(CLI::App& verb, Options& options);

/// Prints one line: words for people, or one JSON object.
void say(const Options& options, const char* verb, ExitCode code, const std::string& text,
         const nlohmann::json& extra = {});
/// The same, and returns the code.
ExitCode finish(const Options& options, const char* verb, ExitCode code, const std::string& text);
/// "no station heard …".
ExitCode noStation(const Options& options, const char* verb);

/// Prints what happens to the drone while the client waits; nothing for machines.
void printEvents(StationClient& client, const Options& options);

/// Sends the command; kOk if accepted, otherwise the exit code, after saying why.
ExitCode ask(StationClient& client, const Options& options, const char* verb,
             const OperatorCommand& command);
/// Why it was refused, with the holder's name where that is the reason.
std::string refusalText(const tautline::command_ack_t& ack, StationClient& client);

[[nodiscard]] std::chrono::milliseconds limitOf(const Options& options,
                                                std::chrono::seconds fallback);

[[nodiscard]] inline Mode modeOf(const tautline::station_state_t& state) {
  return static_cast<Mode>(state.mode);
}
[[nodiscard]] inline const char* modeName(const tautline::station_state_t& state) {
  return nameOf(modeOf(state), kModeNames);
}
[[nodiscard]] inline ConditionSet bitsOf(std::int64_t bits) {
  return ConditionSet::fromBits(static_cast<std::uint64_t>(bits));
}
/// " because of …", or nothing.
[[nodiscard]] std::string becauseOf(std::int64_t bits);
/// Name of the operator who holds the lease, empty: nobody.
[[nodiscard]] std::string holderOf(const tautline::authority_t& authority);

inline constexpr const char* kSilent =
    "the station has fallen silent; it may still fly, look at it";

}  // namespace tautline::cli::flight
