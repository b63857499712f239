#pragma once

/// @file
/// Parameters of the risk model that fit what came of flights. Not real-time safe.

#include <string>
#include <vector>

#include "app/experiments/truth_paths.h"
#include "planning_offline/risk/risk_params.h"

namespace tautline::experiments {

/// The parameters with the risk of an element times its factor, within what the parameter allows;
/// the memberships stay. Rounding (`quantum`) is off: it would undo small factors. Elements read
/// from map layers, and threat and access, are scaled likewise.
[[nodiscard]] planning::RiskParams scaled(planning::RiskParams params,
                                          const planning::PerElement& factors);

/// The same paths as the model with these parameters sees them.
[[nodiscard]] std::vector<TruthPath> reassess(const std::vector<TruthPath>& paths,
                                              std::uint64_t seed,
                                              const planning::RiskParams& params);

struct CalibratedRisk {
  planning::RiskParams params;
  planning::PerElement factors{};  ///< Of each element's risk, from the parameters given.
  int rounds{0};
};

/// Factors by fitFactors() on `seen`. A cost is not quite proportional to its factor where the risk
/// is large, so the fit is repeated with the model's new costs until nothing changes. The paths are
/// those of truthSpace(…, seed, …).
[[nodiscard]] CalibratedRisk calibrate(const std::vector<TruthPath>& seen, std::uint64_t seed,
                                       const planning::RiskParams& params);

}  // namespace tautline::experiments
