#pragma once

/// @file
/// `tautline doctor`: what of this machine is not fit for flight, each with the command that mends
/// it. The checks are in app/cli/doctor.

#include <CLI/App.hpp>

#include "common/error.h"

namespace tautline::cli {

/// Adds the verb to `root`. When it ran, `result` holds its exit code: kOk, or kFailed if there is
/// a problem; advice alone is no failure.
void addDoctorCommand(CLI::App& root, ExitCode& result);

}  // namespace tautline::cli
