#pragma once

#include "app/experiments/experiment.h"

namespace tautline::experiments {

/// Does the risk index tell the truth? Predicted against simulated failures on many maps.
extern const Experiment kRiskTruth;

}  // namespace tautline::experiments
