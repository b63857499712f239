#include "app/cli/mission_command.h"

namespace tautline::cli {

void addMissionCommand(CLI::App& /*root*/, ExitCode& /*result*/) {}

}  // namespace tautline::cli
