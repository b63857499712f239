#pragma once

/// @file
/// A reel that was never calibrated: its scale is found in the first minute of a flight.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kReelScale;

}  // namespace tautline::experiments
