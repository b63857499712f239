#pragma once

/// @file
/// `tautline-bench scenario`: flies scenario files.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::bench {

/// Adds the verb; `result` is set when it is run.
void addScenarioCommand(CLI::App& app, ExitCode& result);

}  // namespace tautline::bench
