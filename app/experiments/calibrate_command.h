#pragma once

/// @file
/// Verb `calibrate` of tautline-bench.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::experiments {

void addCalibrateCommand(CLI::App& app, ExitCode& result);

}  // namespace tautline::experiments
