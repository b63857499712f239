#pragma once

/// @file
/// Dissertation 6.2, second set: straight over the reel, where azimuth means nothing.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kPath2;

}  // namespace tautline::experiments
