#pragma once

#include "app/experiments/experiment.h"
#include "app/station/station_config.h"

namespace tautline::experiments {

/// The integrated demonstration of chapter 7: both viewpoints of the staircase, planned by our
/// planner and flown many times.
extern const Experiment kStaircase;

/// The published software as it flew there: all of the low-level motion suite, so with the
/// corrected localizer, and position control.
[[nodiscard]] StationConfig publishedDemonstration(const Setup& setup);

}  // namespace tautline::experiments
