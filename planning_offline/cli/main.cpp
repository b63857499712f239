/// @file
/// `tautline-plan`: risk reports and risk-aware planning, offline.

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "common/error.h"
#include "planning_offline/cli/commands.h"

int main(int argc, char** argv) {
  using namespace tautline;
  CLI::App app{"Tautline offline planning: where to look from, at the least risk", "tautline-plan"};
  app.require_subcommand(1);
  app.set_version_flag("--version", TAUTLINE_VERSION);
  ExitCode result = ExitCode::kOk;
  planning::addPlanCommand(app, result);
  planning::addWhyCommand(app, result);
  planning::addCompareCommand(app, result);
  planning::addRiskCommand(app, result);
  planning::addContactsCommand(app, result);
  planning::addReachCommand(app, result);
  planning::addFieldsCommand(app, result);
  planning::addScenCommand(app, result);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? static_cast<int>(ExitCode::kOk) : static_cast<int>(ExitCode::kUsage);
  } catch (...) {
    return reportException("tautline-plan");
  }
  return static_cast<int>(result);
}
