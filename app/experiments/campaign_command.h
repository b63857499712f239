#pragma once

/// @file
/// Verb `campaign` of tautline-bench.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::experiments {

void addCampaignCommand(CLI::App& app, ExitCode& result);

}  // namespace tautline::experiments
