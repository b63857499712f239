#include "app/cli/flight_command.h"

#include "app/cli/flight/verbs.h"

namespace tautline::cli {

void addFlightCommands(CLI::App& root, ExitCode& result) {
  flight::addStatusVerb(root, result);
  flight::addModeVerbs(root, result);
  flight::addNavigateVerb(root, result);
  flight::addTeleopVerb(root, result);
  flight::addLeaseVerb(root, result);
  flight::addParamVerb(root, result);
  flight::addFaultsVerb(root, result);
  flight::addHelpVerb(root, result);
}

}  // namespace tautline::cli
