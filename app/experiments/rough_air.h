#pragma once

/// @file
/// The published figures once more, all from one machine, in air as rough as the dissertation says
/// that it was. Needs config/experiments/rough_air.toml.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kRoughAir;

}  // namespace tautline::experiments
