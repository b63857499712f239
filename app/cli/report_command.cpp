#include "app/cli/report_command.h"

namespace tautline::cli {

void addReportCommand(CLI::App& /*root*/, ExitCode& /*result*/) {}

}  // namespace tautline::cli
