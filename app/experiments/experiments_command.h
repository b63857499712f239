#pragma once

/// @file
/// `tautline-bench experiments`: the dissertation's experiments, reproduced and improved.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::experiments {

/// `result` gets the verb's exit code when the verb was chosen; it outlives `app`.
void addExperimentsCommand(CLI::App& app, ExitCode& result);

}  // namespace tautline::experiments
