#pragma once

/// @file
/// Dissertation 6.1: hover at 24 points of a vertical plane; where is the drone really?

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kLocalization;

/// Figure of the row that counts the hovers of which there is nothing to average.
inline constexpr const char* kHoversMissing = "hovers that never came about";

}  // namespace tautline::experiments
