#pragma once

/// @file
/// The operator's verbs that talk to a station: status, lease, flight, mission, sticks, parameters,
/// faults. Each blocks until what it asked for is done, refused or out of time (app/cli/flight).

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::cli {

/// Adds the verbs to `root`. When one ran, `result` holds its exit code; bad input is thrown as
/// InputError.
void addFlightCommands(CLI::App& root, ExitCode& result);

}  // namespace tautline::cli
