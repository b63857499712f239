#include "app/cli/report_command.h"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "app/report/analysis.h"
#include "app/report/flight_log.h"
#include "app/report/report_text.h"
#include "app/report/report_writer.h"
#include "common/mission/scene.h"

namespace tautline::cli {
namespace {

struct Options {
  std::string log;
  std::string folder;
  std::string scene;
  bool json{false};
  bool require_success{false};
};

std::filesystem::path defaultFolder(const std::filesystem::path& log) {
  return log.parent_path() / (log.stem().string() + "_report");
}

ExitCode run(const Options& options) {
  std::optional<Scene> scene;
  if (!options.scene.empty()) scene = sceneInWorld(readScene(options.scene));
  const report::FlightLog log = report::readFlightLog(options.log);
  const report::FlightAnalysis flight = report::analyze(log);
  const std::filesystem::path folder =
      options.folder.empty() ? defaultFolder(options.log) : std::filesystem::path(options.folder);
  const auto files = report::writeReport(log, flight, scene ? &*scene : nullptr, folder);
  if (options.json) {
    std::fputs(report::reportJson(log, flight).c_str(), stdout);
  } else {
    std::fputs(report::summaryText(log, flight).c_str(), stdout);
    std::printf("  %-15s %s (and %zu files beside it)\n", "report", files.front().c_str(),
                files.size() - 1);
  }
  const bool success = flight.outcome.mission_completed && flight.outcome.landed;
  return options.require_success && !success ? ExitCode::kFailed : ExitCode::kOk;
}

}  // namespace

void addReportCommand(CLI::App& root, ExitCode& result) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = root.add_subcommand(
      "report", "What happened in a flight: figures and pictures from its LCM log");
  verb->add_option("log", options->log,
                   "LCM log, as `tautline log record`, lcm-logger or the bench writes it")
      ->required()
      ->type_name("LOG");
  verb->add_option("--out", options->folder,
                   "Folder for the report; default: the log's name with _report")
      ->type_name("DIR");
  verb->add_option("--scene", options->scene, "Scene whose obstacles are drawn")->type_name("FILE");
  verb->add_flag("--json", options->json, "Print report.json instead of the summary");
  verb->add_flag("--require-success", options->require_success,
                 "Exit code 1 unless the mission was completed and the drone landed");
  verb->footer(
      "Example:\n  tautline report flights/demo.lcm --out flights/demo_report\n"
      "The pages' figures are explained in docs/report.md.");
  verb->callback([options, &result] { result = run(*options); });
}

}  // namespace tautline::cli
