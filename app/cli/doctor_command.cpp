#include "app/cli/doctor_command.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/cli/doctor/check.h"
#include "lcmtypes/channels.h"

namespace tautline::cli {
namespace {

struct Options {
  bool real_time{false};
  bool json{false};
  double rate_hz{100.0};
  double seconds{10.0};
  std::string root{"/"};
  std::string config;
  std::string log_folder;
  std::string lcm_url{kDefaultLcmUrl};
};

constexpr const char* kInstalledConfig = "/etc/tautline/station.toml";
constexpr const char* kInstalledLogs = "/var/log/tautline";

nlohmann::json jsonOf(const Check& check, const Finding& f) {
  return {{"check", check.name},
          {"group", nameOf(check.group, kCheckGroupNames)},
          {"status", nameOf(f.status, kFindingStatusNames)},
          {"measured", f.measured},
          {"wanted", f.wanted},
          {"remedy", f.remedy}};
}

void print(const Check& check, const Finding& f) {
  fmt::print("{:8} {:14} {}\n", nameOf(f.status, kFindingStatusNames), check.name, f.measured);
  if (!f.details.empty()) fmt::print("{}", f.details);
  if (!f.wanted.empty()) fmt::print("{:23} wanted: {}\n", "", f.wanted);
  if (!f.remedy.empty()) fmt::print("{:23} remedy: {}\n", "", f.remedy);
  std::fflush(stdout);
}

ExitCode run(const Options& options) {
  Machine machine = thisMachine();
  machine.root = options.root;
  machine.loop_rate_hz = options.rate_hz;
  machine.latency_s = options.seconds;
  machine.lcm_url = options.lcm_url;
  machine.log_folder = !options.log_folder.empty()               ? options.log_folder
                       : std::filesystem::exists(kInstalledLogs) ? kInstalledLogs
                                                                 : ".";
  if (!options.config.empty()) {
    readStationConfig(machine, options.config);
  } else if (std::filesystem::exists(kInstalledConfig)) {
    readStationConfig(machine, kInstalledConfig);
  }
  int problems = 0;
  int advice = 0;
  nlohmann::json findings = nlohmann::json::array();
  for (const Check& check : allChecks()) {
    if (options.real_time && check.group != CheckGroup::kRealTime) continue;
    const Finding finding = check.run(machine);
    problems += finding.status == FindingStatus::kProblem;
    advice += finding.status == FindingStatus::kAdvice;
    if (options.json) {
      findings.push_back(jsonOf(check, finding));
    } else {
      print(check, finding);
    }
  }
  if (options.json) {
    const nlohmann::json out{{"verb", "doctor"}, {"ok", problems == 0}, {"findings", findings}};
    fmt::print("{}\n", out.dump());
  } else {
    fmt::print("{} to mend, {} to consider\n", problems, advice);
  }
  return problems == 0 ? ExitCode::kOk : ExitCode::kFailed;
}

}  // namespace

void addDoctorCommand(CLI::App& root, ExitCode& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = root.add_subcommand(
      "doctor", "What of this machine is not fit for flight, with the commands that mend it");
  verb->add_option("--config", options->config,
                   std::string("Station's TOML file; default: ") + kInstalledConfig +
                       " where it is installed")
      ->type_name("FILE");
  verb->add_option("--log-dir", options->log_folder,
                   std::string("Where logs go; default: ") + kInstalledLogs + ", or here")
      ->type_name("DIR");
  verb->add_option("--lcm-url", options->lcm_url, "Where the station is")->capture_default_str();
  verb->add_flag("--rt", options->real_time, "Only what the real-time loop needs");
  verb->add_option("--rate-hz", options->rate_hz, "Rate of the latency check's loop")
      ->check(CLI::Range(10.0, 1000.0))
      ->capture_default_str();
  verb->add_option("--seconds", options->seconds, "How long the latency check takes")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  verb->add_option("--root", options->root, "Look below this folder instead of /")
      ->capture_default_str()
      ->type_name("DIR");
  verb->add_flag("--json", options->json, "One JSON object for machines");
  verb->footer(
      "Example: tautline doctor --config config/station.toml\nExit code 1 if there is a problem; "
      "advice alone is none.\n"
      "Run it as the user that will fly: rights are that user's.");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace tautline::cli
