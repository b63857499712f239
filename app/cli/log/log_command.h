#pragma once

/// @file
/// `tautline log`: recording, and what can be done with a log. Each subcommand is a file beside
/// this one.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::cli {

/// Adds the verb to `root`. When it ran, `result` holds its exit code.
void addLogCommand(CLI::App& root, ExitCode& result);

/// Its subcommands; called by addLogCommand().
void addLogCheck(CLI::App& log, ExitCode& result);
void addLogExport(CLI::App& log, ExitCode& result);
void addLogInfo(CLI::App& log, ExitCode& result);
void addLogRecord(CLI::App& log, ExitCode& result);
void addLogRecover(CLI::App& log, ExitCode& result);

}  // namespace tautline::cli
