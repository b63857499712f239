#pragma once

/// @file
/// `tautline blackbox FILE`: the last cycles of a station, also of one that was killed.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::cli {

/// Adds the verb to `root`. When it ran, `result` holds its exit code; bad input is thrown as
/// InputError.
void addBlackBoxCommand(CLI::App& root, ExitCode& result);

}  // namespace tautline::cli
