#pragma once

/// @file
/// Dissertation 6.3: round the shaft with none, one and two tether contacts.
/// docs/tether_planning_experiment.md.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kTetherPlanning;

}  // namespace tautline::experiments
