#pragma once

/// @file
/// The published flights of January and February 2018, replayed: docs/real_logs.md.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kRealLogs;

}  // namespace tautline::experiments
