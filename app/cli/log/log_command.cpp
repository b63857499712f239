#include "app/cli/log/log_command.h"

namespace tautline::cli {

void addLogCommand(CLI::App& root, ExitCode& result) {
  CLI::App* log = root.add_subcommand("log", "Record flights; check, mend, show and export logs");
  log->require_subcommand(1);
  addLogRecord(*log, result);
  addLogInfo(*log, result);
  addLogCheck(*log, result);
  addLogRecover(*log, result);
  addLogExport(*log, result);
}

}  // namespace tautline::cli
