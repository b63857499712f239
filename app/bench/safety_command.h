#pragma once

/// @file
/// `tautline-bench safety`: the safety campaign.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::bench {

/// Adds the verb; `result` is set when it is run.
void addSafetyCommand(CLI::App& app, ExitCode& result);

}  // namespace tautline::bench
