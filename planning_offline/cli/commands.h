#pragma once

/// @file
/// The verbs of `tautline-plan`. Each adds itself to the program and stores its exit code. Not
/// real-time safe: offline only.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::planning {

void addPlanCommand(CLI::App& app, ExitCode& result);
void addWhyCommand(CLI::App& app, ExitCode& result);
void addCompareCommand(CLI::App& app, ExitCode& result);
void addRiskCommand(CLI::App& app, ExitCode& result);
void addContactsCommand(CLI::App& app, ExitCode& result);
void addReachCommand(CLI::App& app, ExitCode& result);
void addFieldsCommand(CLI::App& app, ExitCode& result);
void addScenCommand(CLI::App& app, ExitCode& result);

}  // namespace tautline::planning
