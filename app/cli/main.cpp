/// @file
/// `tautline`, the operator's command line.

#include <cstdio>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "app/cli/black_box_command.h"
#include "app/cli/doctor_command.h"
#include "app/cli/flight_command.h"
#include "app/cli/log/log_command.h"
#include "app/cli/mission_command.h"
#include "app/cli/report_command.h"
#include "app/cli/spy/spy_command.h"
#include "app/version.h"
#include "common/error.h"

int main(int argc, char** argv) {
  using namespace tautline;
  CLI::App app{"Tautline operator command line", "tautline"};
  app.require_subcommand(1);
  app.set_version_flag("--version", kVersion);
  ExitCode result = ExitCode::kOk;
  cli::addFlightCommands(app, result);
  cli::addMissionCommand(app, result);
  cli::addReportCommand(app, result);
  cli::addSpyCommand(app, result);
  cli::addLogCommand(app, result);
  cli::addBlackBoxCommand(app, result);
  cli::addDoctorCommand(app, result);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? static_cast<int>(ExitCode::kOk) : static_cast<int>(ExitCode::kUsage);
  } catch (...) {
    return reportException("tautline");
  }
  return static_cast<int>(result);
}
