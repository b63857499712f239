/// @file
/// `tautline faults`: what ended or interrupted flights since the station's start.

#include <ctime>
#include <memory>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/cli/flight/verbs.h"

namespace tautline::cli::flight {
namespace {

constexpr const char* kName = "faults";

std::string timeText(std::int64_t utime) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S}",
                     fmt::localtime(static_cast<std::time_t>(utime / 1'000'000)));
}

const ConditionInfo& conditionAt(std::int8_t index) {
  const auto i = static_cast<std::size_t>(index);
  return kConditionInfos[i < kConditionCount ? i : 0];
}

ExitCode list(const Options& options) {
  StationClient client(options.lcm_url, Role::kListener);
  const auto& v = client.view();
  if (!client.waitUntil([&] { return v.faults.has_value(); },
                        limitOf(options, std::chrono::seconds(5))))
    return noStation(options, kName);
  const auto& f = *v.faults;
  nlohmann::json rows = nlohmann::json::array();
  for (int i = 0; i < f.count && i < tautline::faults_t::CAPACITY; ++i) {
    const ConditionInfo& info = conditionAt(f.condition[i]);
    const char* mode = nameOf(static_cast<Mode>(f.mode[i]), kModeNames);
    rows.push_back({{"utime", f.fault_utime[i]},
                    {"condition", info.name},
                    {"mode", mode},
                    {"text", info.text},
                    {"remedy", info.remedy}});
    if (!options.json && !options.quiet)
      fmt::print("{}  {} -> {}: {}\n{:21}remedy: {}\n", timeText(f.fault_utime[i]), info.name, mode,
                 info.text, "", info.remedy);
  }
  say(options, kName, ExitCode::kOk,
      f.count == 0 ? "none since the station's start"
      : f.latched  ? "latched: no arming before `tautline faults --clear` or `tautline disarm`"
                   : "not latched",
      {{"latched", f.latched != 0}, {"faults", rows}});
  return ExitCode::kOk;
}

ExitCode clear(const Options& options) {
  StationClient client(options.lcm_url, Role::kOperator);
  const ExitCode code = ask(client, options, kName, {.service = Service::kClearFaults});
  return code == ExitCode::kOk ? finish(options, kName, code, "cleared") : code;
}

}  // namespace

void addFaultsVerb(CLI::App& root, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  const auto clears = std::make_shared<bool>(false);
  CLI::App* verb = addVerb(
      root, kName, "What ended or interrupted flights since the station's start, with remedies",
      "tautline faults --clear", *options);
  verb->add_flag("--clear", *clears, "you have looked: they no longer forbid arming; STANDBY only");
  verb->callback(
      [options, clears, &result] { result = *clears ? clear(*options) : list(*options); });
}

}  // namespace tautline::cli::flight
