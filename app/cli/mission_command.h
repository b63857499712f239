#pragma once

/// @file
/// `tautline mission check|import|show|svg`: mission files from the command line.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::cli {

/// Adds the verb to `root`. When it ran, `result` holds its exit code; bad input is thrown as
/// InputError.
void addMissionCommand(CLI::App& root, ExitCode& result);

}  // namespace tautline::cli
