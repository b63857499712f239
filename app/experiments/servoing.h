#pragma once

/// @file
/// Dissertation 6.4: keep a fixed pose before a marker that is carried around.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kServoing;

}  // namespace tautline::experiments
