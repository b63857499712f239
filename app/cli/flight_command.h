#pragma once

/// @file
/// `tautline status|arm|disarm|takeoff|navigate|hold|land|stop`: the flight from the command line.
/// Each verb blocks until what it asked for is done, refused or out of time.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::cli {

/// Adds the verbs to `root`. When one ran, `result` holds its exit code; bad input is thrown as
/// InputError.
void addFlightCommands(CLI::App& root, ExitCode& result);

}  // namespace tautline::cli
