#pragma once

/// @file
/// `tautline report LOG`: what a flight's log says, as text, JSON, HTML and SVG pictures.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::cli {

/// Adds the verb to `root`. When it ran, `result` holds its exit code; bad input is thrown as
/// InputError.
void addReportCommand(CLI::App& root, ExitCode& result);

}  // namespace tautline::cli
