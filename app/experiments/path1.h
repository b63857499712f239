#pragma once

/// @file
/// Dissertation 6.2, first set: a corner in the open, five densities of waypoints, both laws.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kPath1;

}  // namespace tautline::experiments
