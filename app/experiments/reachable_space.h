#pragma once

/// @file
/// Dissertation 6.3: how much of a room with a shaft a straight tether reaches, and how much one
/// with contacts.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kReachableSpace;

}  // namespace tautline::experiments
