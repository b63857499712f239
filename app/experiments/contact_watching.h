#pragma once

/// @file
/// Contacts that come off, slip, are missing or were not planned: how soon the station tells, and
/// how often it tells of one that there is not.

#include "app/experiments/experiment.h"

namespace tautline::experiments {

extern const Experiment kContactWatching;

}  // namespace tautline::experiments
