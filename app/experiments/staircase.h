#pragma once

#include "app/experiments/experiment.h"

namespace tautline::experiments {

/// The integrated demonstration of chapter 7: both viewpoints of the staircase, planned by our
/// planner and flown many times.
extern const Experiment kStaircase;

}  // namespace tautline::experiments
