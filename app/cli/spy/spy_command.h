#pragma once

/// @file
/// `tautline spy`: every LCM channel with its rate and its decoded fields, in a terminal or as
/// JSON.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::cli {

/// Adds the verb to `root`. When it ran, `result` holds its exit code: kTimeout if --once heard
/// nothing.
void addSpyCommand(CLI::App& root, ExitCode& result);

}  // namespace tautline::cli
