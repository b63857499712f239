// `tautline log check` and `tautline log recover`: two ways to use one check.

#include <filesystem>
#include <memory>
#include <string>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/log/log_command.h"
#include "app/log/event_log_writer.h"
#include "app/log/log_check.h"

namespace tautline::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string log;
  std::string out;
  bool json{false};
};

ExitCode show(const Options& options, const char* verb, const LogCheck& check) {
  if (options.json) {
    nlohmann::json damage = nlohmann::json::array();
    for (const LogDamage& d : check.damage)
      damage.push_back({{"offset", d.offset},
                        {"bytes", d.bytes},
                        {"what", d.what},
                        {"events_lost", d.events_lost},
                        {"at_least", d.at_least}});
    fmt::print("{}\n", nlohmann::json{{"verb", verb},
                                      {"ok", check.damage.empty()},
                                      {"log", options.log},
                                      {"bytes", check.bytes},
                                      {"events", check.events},
                                      {"damage", damage}}
                           .dump());
  } else {
    for (const LogDamage& d : check.damage) fmt::print("  {}\n", describe(d));
    fmt::print("{}: {} events whole, {} bytes; {}\n", options.log, check.events, check.bytes,
               check.damage.empty() ? "no damage" : summary(check.damage));
  }
  return check.damage.empty() ? ExitCode::kOk : ExitCode::kFailed;
}

ExitCode check(const Options& options) {
  return show(options, "log check", checkLog(options.log, [](const LogEvent&) {}));
}

/// The finished file appears under its name at once, or not at all.
ExitCode recover(const Options& options) {
  std::error_code ignored;
  if (fs::equivalent(options.log, options.out, ignored))
    throw InputError({.file = options.out,
                      .problem = "is the damaged log itself, which is never overwritten",
                      .remedy = "give -o another name"});
  const fs::path unfinished = options.out + ".unfinished";
  LogCheck found;
  try {
    EventLogWriter writer(unfinished);
    bool good = true;
    found = checkLog(options.log, [&](const LogEvent& event) {
      good = good && writer.write(event.channel, event.utime, event.data);
    });
    if (!good || !writer.sync())
      throw InputError({.file = options.out,
                        .problem = "cannot be written, the disk is full",
                        .remedy = "choose a folder with more room"},
                       ExitCode::kFailed);
    fs::rename(unfinished, options.out);
  } catch (...) {
    fs::remove(unfinished, ignored);
    throw;
  }
  return show(options, "log recover", found);
}

}  // namespace

void addLogCheck(CLI::App& log, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb =
      log.add_subcommand("check", "Is a log whole? Exit code 1 if not, with what and where");
  verb->add_option("log", options->log, "LCM log")->required()->type_name("LOG");
  verb->add_flag("--json", options->json, "One JSON object for machines");
  verb->footer("Example: tautline log check flight.lcm");
  verb->callback([options, &result] { result = check(*options); });
}

void addLogRecover(CLI::App& log, ExitCode& result) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = log.add_subcommand(
      "recover", "Write all that is whole of a damaged log; exit code 1 if anything was lost");
  verb->add_option("log", options->log, "damaged LCM log; stays as it is")
      ->required()
      ->type_name("LOG");
  verb->add_option("-o,--out", options->out, "log to write")->required()->type_name("LOG");
  verb->add_flag("--json", options->json, "One JSON object for machines");
  verb->footer("Example: tautline log recover broken.lcm -o mended.lcm");
  verb->callback([options, &result] { result = recover(*options); });
}

}  // namespace tautline::cli
