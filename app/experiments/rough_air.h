#pragma once

/// @file
/// The published figures once more in air in which flights of a path end as differently as they did
/// on the staircase. Needs config/experiments/rough_air.toml.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kRoughAir;

}  // namespace tautline::experiments
