#pragma once

/// @file
/// Dissertation 6.1: hover at 24 points of a vertical plane; where is the drone really?

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kLocalization;

}  // namespace tautline::experiments
