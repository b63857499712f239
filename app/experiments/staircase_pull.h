#pragma once

/// @file
/// The staircase flown with other pulls on the tether: what decides the published software's
/// success. Not real-time safe.

#include <memory>
#include <vector>

#include "app/experiments/experiment.h"
#include "app/experiments/staircase_paths.h"

namespace tautline::experiments {

/// Both stations, both paths. Our station is told the pull; the published correction has no use for
/// it. The same machines at each pull.
[[nodiscard]] std::vector<Trial> stairPullTrials(const Setup& setup,
                                                 const std::shared_ptr<const Stairs>& stairs);

/// Adds the picture of success over the pull, and the table of how flights ended.
void addStairPulls(const Setup& setup, const Results& results, Findings& findings);

}  // namespace tautline::experiments
