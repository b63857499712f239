#pragma once

/// @file
/// `tautline mission svg`: a picture of a mission file.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::cli {

/// Adds the verb `svg` to `mission`. When it ran, `result` holds its exit code; bad input is thrown
/// as InputError.
void addMissionSvgCommand(CLI::App& mission, ExitCode& result);

}  // namespace tautline::cli
